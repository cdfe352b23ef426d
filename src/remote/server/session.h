// One client of the render server: its buffers, messages and frame. All memory is in the session's own block, so a
// client can exhaust only its own.
#pragma once
#include "engine/exposure.h"
#include "platform/link.h"
#include "present/pack.h"
#include "remote/server/scene_store.h"
#include "remote/server/share.h"
#include "remote/stream.h"
#include "wire/codec.h"
#include "wire/row_sequence.h"

namespace pocketray {

// Longest message from a device. Derived: twice the longest today, a frame_request of 268 bytes (PROTOCOL.md), since
// settings may be added.
constexpr std::uint32_t kRequestBytesMax = 512;
constexpr std::size_t kInputBytes = 4096;  // limit on unread input from a client; chosen: eight of the longest messages
// Longest reply except row_chunk. Derived: a scene_piece has 32 bytes besides the piece, other replies at most 112.
constexpr std::size_t kReplyBytesMax = kPieceBytesMax + 128;
// Renders more rows only while at most this much waits to be sent: system buffers keep the link busy meanwhile, and
// rows sent too early cannot be cancelled. Chosen: 3 ms of a 10 Mbit/s link.
constexpr std::size_t kAheadBytes = 4096;
// Chosen: a tenth of the shortest round trip of interest. Shorter preparations of a frame are not stated.
constexpr std::uint64_t kPreparationStatedNs = 100'000;

// Smallest block of a session: its buffers and a small picture of a small scene. Chosen: the message buffers take 1.1
// MiB and the radiance of a 320×240 picture 0.9 MiB.
constexpr std::size_t kSessionBytesMin = 4u << 20;

enum class SessionPhase : std::uint8_t {
  unused,
  serving,
  leaving,  // told why; further input is read and dropped
};

// The next stage of a job. Each takes one slice of CPU time, or as many as its pixels need.
enum class JobStage : std::uint8_t {
  plan,           // codec and memory of the renderer
  build,          // the renderer
  own_exposure,   // of the scene, if it must be measured
  aim,            // camera, time, lights
  search,         // for changes since the last frame
  view_exposure,  // of a view_query, answered afterwards
  coarse,         // the coarse picture, if requested
  rows,
  light,  // a map of indirect light, before any rows
};

// The frame that a client waits for. Its rows are traced and sent in the request's order; the image holds the first
// traced_columns pixels of the next row to trace.
struct FrameJob {
  const StoredScene* scene;  // null: no job
  FrameRequest request;
  bool is_view_query, measure_exposure;  // if is_view_query, only the fields of `request` that a query also has are set
  JobStage stage;
  ExposureProbe probe;
  RowSequence traced, sent;  // rows left to trace, and to send
  std::uint32_t rows_traced, rows_sent;
  std::uint32_t traced_columns;
  std::uint32_t coarse_row, coarse_column, coarse_rows;  // next pixel on the grid of the coarse picture; rows at once
  bool has_coarse;                                       // traced and waiting to be sent
  bool has_light, sent_light;          // likewise for a light map, whose grid the fields above then use
  bool codes_beside;                   // its finished chunk is coded in parallel with the next slice
  std::uint64_t work_ns, pixel_count;  // of rows traced but not completely sent
  std::uint64_t took_ns;               // CPU time so far,
  std::uint64_t build_ns;              // including the renderer's preparation,
  std::uint64_t prepare_ns;            // and the time before the first pixel
  // Number of pixels traced per row of the picture, if several ranks share the job: its complete rows are then packed.
  // Null: only this program renders.
  const std::uint32_t* row_pixels;
};

// Work traced at once: whole rows, pixels of a slow row, or pixels of an exposure.
struct Slice {
  std::uint32_t row_count, column_end, pixel_count;  // column_end: the job's next traced_columns
  std::uint32_t traced_count;                        // of the pixels; the others are the last frame's
  bool is_probe, is_coarse;
  bool is_light;        // pixels are lights of a light map
  bool is_preparation;  // of a frame before its first pixel
};

struct Session;

// Other ranks that trace rows of all jobs together with this one; implemented in remote/cluster/.
struct HelperRanks {
  void* context;
  // Announces a job before its frame is prepared, and sets its row_pixels.
  void (*begin)(void* context, Session* session);
  // Traces next pixels of the job with them, for about `slice_ns`, and packs complete rows.
  Slice (*trace)(void* context, Session* session, std::uint64_t slice_ns);
};

// Rendering resources shared by all clients.
struct JobTools {
  std::uint32_t thread_count;
  Workers* workers;
  CoherenceMode coherence;
  const HelperRanks* helpers = nullptr;
};

struct Session {
  SessionPhase phase = SessionPhase::unused;
  char name[64] = {0};                  // the peer's address
  char reason[160] = {0};               // why it must leave
  std::uint32_t message_bytes_max = 0;  // largest message the client accepts
  int address = -1;                     // index of the server's account for its address
  std::uint64_t seated_ns = 0;          // when it got its place
  Account account;
  std::uint64_t ended_took_ns = 0, ended_sent_ns = 0, ended_build_ns = 0;  // of finished frames not yet accounted for
  std::uint32_t chunk_count = 0;                                           // sent to the client

  Arena block;
  std::size_t frame_mark = 0;     // in the block, behind the buffers
  std::size_t touched_bytes = 0;  // part of the block that the system has provided by now
  MessageStream messages;
  bool more_to_take = false;  // complete messages may wait in the input

  CodecShape shape;               // of the last request
  RowEncoder* encoder = nullptr;  // null: not yet created for the shape
  Array<std::uint8_t> pixels;     // the picture in wire format
  Renderer renderer;
  const StoredScene* built_scene = nullptr;  // the scene the renderer is built for; null: none
  Camera own_camera;                         // the scene's own camera with the renderer's index
  float own_exposure = 0;                    // 0: not yet measured

  FrameJob job = {};
  FrameRequest request;                            // the last request, met or refused; frame 0: none
  std::uint64_t job_number = 0;                    // counts jobs, including those of earlier clients
  std::uint32_t frame_last = 0;                    // number of the last request
  std::uint64_t coded_pixels = 0, code_bytes = 0;  // since the server last took them
  double trace_ns = 0, probe_ns = 0;   // thread time of an expensive pixel, and of an exposure pixel; 0: unknown
  double light_ns = 0;                 // of an expensive light of a light map; 0: unknown
  double code_pixel_ns = 0;            // to code a pixel, as last measured
  std::uint32_t pixel_ps = 0;          // recent work on a pixel
  std::uint16_t price = kPriceUnit;    // for the client, as of the last choice
  std::uint16_t price_stated = 0;      // in the last chunk or pong; 0: in none
  std::uint64_t waiting_since_ns = 0;  // when it began waiting for its turn; 0: not waiting

  platform::LinkTimer message_timer, idle_timer, stall_timer, leave_timer;
  std::uint64_t frame_count = 0, row_count = 0;  // sent
};

// Places the buffers in the block.
void make_session(void* memory, std::size_t byte_count, Session* session);
// Resets it for another client on that connection.
void restart_session(Session* session, platform::Link* link, int connection);

// True if messages may wait and there is room to answer them.
bool wants_messages(const Session& session);

// Queues a message; it must fit.
void send_message(Session* session, const Message& message);
void send_error(Session* session, WireError code, std::uint32_t frame);

// True if there is a job.
inline bool has_job(const Session& session) { return session.job.scene != nullptr; }
// Ends the job and charges as wasted the time of rows not sent, or beyond the sent fraction of the requested rows.
void drop_job(Session* session);
// True if the coarse picture or a chunk of the job is completely traced and may be queued.
bool has_chunk(const Session& session);
// True if there is a frame to render and the client keeps up with its output.
bool can_work(const Session& session);

// Advances a job by a slice, of about `slice_ns` if it consists of pixels. Fails if the request cannot be met; *code
// receives the reason.
Status step_job(Session* session, const JobTools& tools, std::uint64_t slice_ns, Slice* slice, WireError* code);
// Answers a view_query, which ends the job.
Status answer_view_query(Session* session);
// Number of pixels that one thread traces in about `slice_ns`, at `known_ns` each (0: unknown). Bounded so that it
// holds even if pixels suddenly become as expensive as the settings allow: background may cost a thousandth of the room
// behind it.
std::uint32_t slice_pixels(const Settings& settings, std::uint32_t light_point_count, double known_ns,
                           std::uint64_t slice_ns);
// Updates the time of an expensive pixel after pixels of `new_ns` each: falls slowly if they are cheap. By an eighth,
// chosen: it halves in five slices, so that background between expensive pixels does not hide them.
inline double dear_pixel_ns(double known_ns, double new_ns) {
  return new_ns > 0.875 * known_ns ? new_ns : 0.875 * known_ns;
}
// Returns whether the coarse picture is requested and fits a message.
bool wants_coarse(const Session& session);
// Traces the next pixels of the coarse picture, for about `slice_ns`; sends it.
Slice trace_coarse(Session* session, std::uint64_t slice_ns);
void send_coarse(Session* session);
inline PixelFormat pack_format(WireFormat format) { return format == WireFormat::rgb565 ? kRgb565 : kRgb888; }
// Lists the next rows to trace, at most kRunCountMax ranges; returns their number.
std::uint32_t next_ranges(const FrameJob& job, std::uint32_t row_count, RowRange* ranges);
// Fails if no message can hold the light map that the job requests.
Status check_light_map(const Session& session);
// Traces and accounts for next lights, for about `slice_ns`; sends the map, which ends a job without rows.
Slice trace_light(Session* session, std::uint64_t slice_ns);
void end_light_slice(Session* session, const Slice& slice, std::uint64_t took_ns);
void send_light(Session* session);
// Picoseconds per pixel, as messages state them.
std::uint32_t picoseconds(std::uint64_t ns, std::uint64_t pixel_count);
// Traces the next pixels of the job, for about `slice_ns`, and codes the finished chunk in parallel if codes_beside.
Slice trace_slice(Session* session, std::uint64_t slice_ns);
// Packs rows of the image into the session's picture.
void pack_session_rows(Session* session, std::uint32_t row_begin, std::uint32_t row_end);
// Accounts for a slice that took that much CPU time.
void end_slice(Session* session, const Slice& slice, std::uint64_t took_ns);
// Codes and queues the coarse picture and completely traced chunks as far as the queue has room; the last one ends the
// job.
void send_chunks(Session* session);

}  // namespace pocketray
