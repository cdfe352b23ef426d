// One client of the render server: its buffers, its messages, its frame. Everything lies in the session's own block,
// so whatever a client asks for is at its own expense.
#pragma once
#include "engine/exposure.h"
#include "platform/link.h"
#include "remote/server/scene_store.h"
#include "remote/server/share.h"
#include "remote/stream.h"
#include "wire/codec.h"

namespace pocketray {

constexpr std::uint32_t kRequestBytesMax = 512;               // of any message that a device sends
constexpr std::size_t kInputBytes = 4096;                     // what a client can have on its way into the server
constexpr std::size_t kReplyBytesMax = kPieceBytesMax + 128;  // of any message but a row_chunk
// Rows are made while no more than this waits to be sent: what the system has buffered keeps the line busy meanwhile,
// and what is sent too early cannot be cancelled.
constexpr std::size_t kAheadBytes = 4096;

// The least block of a session: what its buffers take, and a small picture of a small scene.
constexpr std::size_t kSessionBytesMin = 4u << 20;

enum class SessionPhase : std::uint8_t {
  unused,
  serving,
  leaving,  // is told why, and what it still sends is read and dropped
};

// What is next to be done for a job. Each stage takes one slice of the CPU, or as many as its pixels need.
enum class JobStage : std::uint8_t {
  plan,           // codec and renderer
  own_exposure,   // of the scene, where it is to be measured
  aim,            // camera, time, lights
  view_exposure,  // of a view_query, which is answered then
  rows,
};

// The frame that a client waits for. Rows from traced_begin on are in the image, and of the one above the first
// traced_columns pixels; rows from sent_begin on are sent.
struct FrameJob {
  const StoredScene* scene;  // null: there is nothing to do
  FrameRequest request;
  bool is_view_query, measure_exposure;  // only what a request holds that a query has, too, means something
  JobStage stage;
  ExposureProbe probe;
  std::uint32_t chunk_rows;  // of the last chunk; 0: none has been sent
  std::uint32_t traced_begin, traced_columns, sent_begin;
  std::uint64_t wall_ns, pixel_count;  // of the rows that are traced and not all sent
  std::uint64_t took_ns;               // of the CPU so far
};

// What is traced in one go: whole rows, or pixels of one where a row takes long, or pixels of an exposure.
struct Slice {
  std::uint32_t row_count, column_end, pixel_count;  // column_end: the job's next traced_columns
  bool is_probe;
};

// What renders for all clients.
struct JobTools {
  std::uint32_t thread_count;
  Workers* workers;
};

struct Session {
  SessionPhase phase = SessionPhase::unused;
  char name[64] = {0};                  // the peer's address
  char reason[160] = {0};               // why it is to leave
  std::uint32_t message_bytes_max = 0;  // that the client takes
  int address = -1;                     // the server's account of its address
  Account account;
  std::uint64_t ended_took_ns = 0, ended_sent_ns = 0;  // of frames at their end that are not accounted for yet
  std::uint32_t chunk_count = 0;                       // sent to it

  Arena block;
  std::size_t frame_mark = 0;  // of the block, behind the buffers
  MessageStream messages;
  bool more_to_take = false;  // whole messages may wait in the input

  CodecShape shape;               // of the last request
  RowEncoder* encoder = nullptr;  // null: to be made for the shape
  Array<std::uint8_t> pixels;     // the picture as the wire has it
  Renderer renderer;
  const StoredScene* built_scene = nullptr;  // that the renderer is built for; null: none
  Camera own_camera;                         // the scene's own of the renderer's index
  float own_exposure = 0;                    // 0: to be measured

  FrameJob job = {};
  FrameRequest request;                // the last one, be it met or refused; frame 0: there was none
  std::uint64_t job_number = 0;        // counts jobs, of clients before this one too
  std::uint32_t frame_last = 0;        // number of the last request
  double trace_ns = 0, probe_ns = 0;   // what a dear pixel takes all threads, and one of an exposure; 0: unknown
  std::uint32_t pixel_ps = 0;          // what a pixel cost the client, of late: time it had to wait included
  std::uint64_t waiting_since_ns = 0;  // for its turn; 0: it does not wait

  platform::LinkTimer message_timer, idle_timer, stall_timer, leave_timer;
  std::uint64_t frame_count = 0, row_count = 0;  // sent
};

// Takes the buffers out of the block.
void make_session(void* memory, std::size_t byte_count, Session* session);
// Another client comes, by that connection.
void restart_session(Session* session, platform::Link* link, int connection);

// Whether messages may wait that there is room to answer.
bool wants_messages(const Session& session);

// Queues a message; there must be room.
void send_message(Session* session, const Message& message);
void send_error(Session* session, WireError code, std::uint32_t frame);

// Whether all rows of the job are traced or, `sent`, sent.
inline bool has_job(const Session& session) { return session.job.scene != nullptr; }
// Ends it, and notes what it took for nothing: rows that are not sent.
void drop_job(Session* session);
// Whether a chunk of the job is traced as a whole and may be queued.
bool has_chunk(const Session& session);
// Whether a part of the frame can be made now: there is one, and the client keeps up with what it gets.
bool can_work(const Session& session);

// Takes a job a slice further, which takes about `slice_ns` if it consists of pixels. Fails where the request cannot be
// met; *code says why.
Status step_job(Session* session, const JobTools& tools, std::uint64_t slice_ns, Slice* slice, WireError* code);
// Answers a job that is a view_query, which ends it.
Status answer_view_query(Session* session);
// Pixels that one thread traces in about `slice_ns` where `known_ns` is what each takes (0: unknown). No more than it
// can trace in about that time where they suddenly are as dear as such settings make them: the background before a
// room costs a thousandth of the room.
std::uint32_t slice_pixels(const Settings& settings, std::uint32_t light_point_count, double known_ns,
                           std::uint64_t slice_ns);
// What a dear pixel takes, after some have taken `new_ns` each: cheap ones are believed slowly.
inline double dear_pixel_ns(double known_ns, double new_ns) {
  return new_ns > 0.875 * known_ns ? new_ns : 0.875 * known_ns;
}
// Traces the next pixels of the job, for about `slice_ns`.
Slice trace_slice(Session* session, std::uint64_t slice_ns);
// Counts them: they took the threads `took_ns`, and the client `wall_ns`.
void end_slice(Session* session, const Slice& slice, std::uint64_t took_ns, std::uint64_t wall_ns);
// Queues the chunks that are traced as a whole, as far as the queue may take them; the last one ends the job.
void send_chunks(Session* session);

}  // namespace pocketray
