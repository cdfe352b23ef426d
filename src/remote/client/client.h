// Client: the device's side of the split ([Aranha07] sec. 3.2-3.3). It keeps a connection to each render server, learns
// in an overture what they and the link can do, asks them for their rows of each frame and merges what comes with the
// device's own. A server that is late or gone costs time and no pixel. One that sends wrong pixels is found by spot
// checks (client_verify.h), with a probability that is known; what it sent before may have been shown.
// Everything lies in one arena; time is the link's, and nothing waits but where the link is polled.
#pragma once
#include "engine/pace.h"
#include "engine/renderer.h"
#include "remote/client/verify.h"
#include "remote/stream.h"
#include "split/cost_model.h"
#include "split/merge.h"
#include "wire/codec.h"

namespace pocketray {

// Rows that a server sends at once: at the ends of a frame and at most between; and everywhere where chunks do not
// grow. Larger ones take fewer headers and compress better, smaller ones keep nobody waiting; measured by split-report.
constexpr std::uint32_t kChunkRowsMin = 4, kChunkRowsMax = 32, kChunkRowsEven = 8;

struct ClientOptions {
  WireFormat format = WireFormat::rgb888;
  bool dither = false;
  SplitWish wish;
  double cost_per_device_pixel = 0, cost_per_byte = 0;  // energy, in the unit of the wish
  double cost_per_megabyte = 0;                         // price of 10⁶ bytes
  double device_share = -1;                             // in [0, 1]: a fixed m, for comparisons; below 0: the best
  bool device_goes_on = true;                           // into rows that have not come; false: for comparisons
  Pace pace;                                            // the CPU to emulate
  const float* row_costs = nullptr;                     // on it, see row_costs.h
  bool has_scene = true;              // false: the device renders nothing, and shows what servers render
  int check_count = kCheckCountAuto;  // of servers' pixels in a frame, at most kSpotChecksMax; 0: none
  // Gives random numbers that no server can foresee, as platform/entropy.h; null: the same ones every time, for tests.
  bool (*entropy)(void* bytes, std::size_t byte_count) = nullptr;
  std::uint64_t connect_timeout_ns = 3'000'000'000;
  std::uint64_t silence_timeout_ns = 3'000'000'000;   // without an answer, half a message included
  std::uint64_t prepare_timeout_ns = 30'000'000'000;  // the same till the first rows: the server builds its scene first
  std::uint64_t retry_ns_min = 500'000'000, retry_ns_max = 30'000'000'000;
  void (*log)(void* context, const char* line) = nullptr;  // one line when a server is lost and when it is back
  void* log_context = nullptr;
};

enum class ServerPhase : std::uint8_t {
  waiting,  // for the next try to connect
  connecting,
  greeting,   // hello
  asking,     // for the scene
  measuring,  // the link: pings
  probing,    // the server: its first rows
  ready,
};

const char* phase_text(ServerPhase phase);
// What an error that a server reports means, and what to do about it.
const char* wire_error_text(WireError code);

// What became of a server's rows in a frame.
struct ServerFrame {
  std::uint32_t row_begin = 0, row_end = 0;  // asked for
  std::uint32_t rows_come = 0;               // of them, also those that the device had already done
  std::uint64_t asked_ns = 0, bytes = 0;
  std::uint64_t row_bytes = 0;     // of them, what the rows take without their messages
  double render_ns = 0;            // of the rows that have come, by the server's word
  bool open = false;               // rows are still to come
  std::uint64_t heard_ns = 0;      // when rows came last
  std::uint64_t first_ns = 0;      // and first
  std::uint64_t bytes_behind = 0;  // of the chunks behind the first
  double render_behind_ns = 0;     //   and what their rows took the server
  bool answers = false;            // it has answered since it was asked, be it a ping
};

struct RemoteServer {
  platform::LinkAddress address;
  ServerPhase phase = ServerPhase::waiting;
  MessageStream messages;
  RowDecoder* decoder = nullptr;
  platform::LinkTimer timer;                           // of the phase: the next try, or when it counts as lost
  std::uint64_t retry_ns = 0;                          // till the next try
  bool told = false;                                   // why it is not in use
  bool lied = false;                                   // it has sent wrong pixels: never used again
  std::uint64_t useful_ns = 0;                         // since when this connection has brought rows; 0: none so far
  std::uint32_t ping_id = 0, ping_bytes = 0;           // that an answer is awaited to, and its payload; id 0: none
  std::uint32_t pings_answered = 0, pings_missed = 0;  // missed: the answer came unwatched
  std::uint64_t ping_ns = 0, ping_due_ns = 0;
  bool ping_alone = false;  // no rows of any server were under way when it was sent
  double round_trip_ns = 0, ns_per_byte = 0;
  double scaled = 1;                 // ns_per_byte, by what rows took, since it was measured by itself
  std::uint64_t quiet_until_ns = 0;  // its link is measured meanwhile: no rows are asked of others
  std::uint64_t anew_ns = 0;         // not before then its link is measured anew
  double probe_ns_per_pixel = 0;
  Smoothed row_ns;                 // of a device without the scene: that a row took, from the request until it came
  FrameRequest asked;              // last; frame 0: nothing with this connection
  std::uint32_t due_end = 0;       // of that, rows [asked.row_begin, due_end) have yet to come
  std::uint64_t late_rows = 0;     // of what was asked for before, which may still be under way; so much of that when
  std::uint64_t late_at_ping = 0;  // the ping was sent
  bool more = false;               // has come and not been looked at: a look takes no more than a frame can bring
  bool unanswered = false;         // since rows were asked for; asking anew gives no more time
  std::uint32_t chunk_count = 0;   // that have come with this connection
  std::uint8_t chunk_growth = 0;   // 16ths, see FrameRequest; 0: they do not grow
  ServerFrame frame;
  bool is_witness = false;   // it is asked for a row of another's; meanwhile its own rows are
  ServerFrame frame_before;  //   those of
  ServerChecks checks;
};

// A frame as it went, for people and for the report.
struct FrameShare {
  std::uint32_t frame = 0;
  double predicted_ns = 0;                          // by the split that was chosen; 0: nothing was known yet
  double measured_ns = 0;                           // from its preparation to its completion
  double local_ns = 0;                              // predicted for the device alone; 0: not known
  std::uint32_t device_rows = 0;                    // rendered by the device
  std::uint32_t server_rows[kServerCountMax] = {};  // that were a server's
  std::uint32_t row_begin[kServerCountMax] = {}, row_end[kServerCountMax] = {};  // that they were asked for
  std::uint64_t server_bytes[kServerCountMax] = {};                              // received for it
  std::uint32_t checked[kServerCountMax] = {};  // of their pixels; of their rows where the device has no scene
  std::uint32_t lies = 0;                       // servers found to send wrong pixels
  std::uint64_t row_bytes = 0;                  // received, of the rows alone, without their messages
  std::uint64_t bytes_in = 0, bytes_out = 0;    // on the wire, of all connections
};

// The time in which rows of a frame came in: from the first chunk, which began nobody knows when, to the last.
struct Arrivals {
  std::uint64_t first_ns = 0, last_ns = 0, bytes = 0;  // bytes: of the chunks behind the first
  std::uint64_t gap_ns_max = 0;                        // between two looks at the link
};

// The row that the device renders in parts, as it takes longer than the device may work at once.
struct DeviceRow {
  bool in_parts = false;  // there is one
  std::uint32_t row = 0, columns_done = 0;
  double pixel_ns = 0;        // of the last part, or of earlier rows; 0: not known
  std::uint64_t took_ns = 0;  // so far
};

struct Client {
  ClientOptions options;
  platform::Link* link = nullptr;
  Settings settings;
  ContentHash scene;
  std::uint32_t server_count = 0;
  RemoteServer servers[kServerCountMax];
  CostModel model;
  SplitWorkspace workspace;
  Split split;
  Merge merge;
  Verifier verifier;
  Array<std::uint8_t> pixels;  // the merged frame in the wire's format, rows without padding
  // The current frame.
  FrameRequest request;
  bool complete = true, joined = false;
  bool held = false;  // rows are asked for once a link is measured
  std::uint64_t begin_ns = 0, waited_ns = 0, looked_ns = 0;
  std::uint64_t prepare_ns = 0;  // of work on it before it began
  mutable platform::LinkClock clock;
  std::uint64_t unwatched_ns = 0;  // before the latest look: by so much what came may have come earlier
  Arrivals arrivals;
  DeviceRow device_row;
  double device_ns = 0;  // that its rows took, in this frame
  std::uint32_t device_rows = 0;
  std::uint32_t dirty_begin = 0, dirty_end = 0;  // rows changed since take_merged_rows()
  std::uint64_t frames_with_servers = 0;         // since a server came into use
  std::uint64_t bytes_in_before = 0, bytes_out_before = 0;
  FrameShare share;               // of the last complete frame
  std::uint64_t progress_ns = 0;  // when rows that were missing came last
};

// The level at which rows are asked for from a link of that speed, as zlib counts.
std::uint8_t deflate_level(double ns_per_byte);

// Bytes of an arena for pictures of that size. The number of streams of the link that it takes is server_count.
std::size_t client_need(const Settings& settings, WireFormat format, std::uint32_t server_count);
// The addresses are resolved; nothing has connected yet. The client stays where it has been made.
Status make_client(const ClientOptions& options, const Settings& settings, const ContentHash& scene,
                   platform::Link* link, const platform::LinkAddress* servers, std::uint32_t server_count, Arena* arena,
                   Client* client);
// Says goodbye and closes the connections.
void close_client(Client* client);

// Lets connections, overtures and arriving rows go on; waits `timeout_ns` at most for something to come.
void advance_client(Client* client, std::uint64_t timeout_ns);

// Begins a frame that the renderer is prepared for, or, without the scene, has camera and exposure of, `prepare_ns` of
// work ago: plans the split and asks for the servers' rows. `seconds` is the time of the animation. A frame that was
// not finished is given up.
void begin_client_frame(Client* client, const Renderer& renderer, double seconds, std::uint64_t prepare_ns);
// Rows that the device is to render next, at most `row_count_max`; false: there are none left.
bool take_device_rows(Client* client, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end);
// The device has rendered them, which took it so long by the wall clock, and their pixels are in client->pixels.
void finish_device_rows(Client* client, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t ns);
// Takes over what the frame told, and lets servers drop what is left of it. Called once, when all rows are there.
void end_client_frame(Client* client);

// Whether the frame has all its rows.
inline bool has_all_rows(const Client& client) { return is_complete(client.merge); }
// How long the device may work at once before it looks at the link again; shorter while an answer is timed.
double work_ns_max(const Client& client);
// Whether every server is in use, or waits for its next try after a failure that was told: what can be known is known.
bool is_settled(const Client& client);
// Whether a device without the scene had better give up: no row has come for five seconds, nor has a server that is
// asked for some answered a ping; or for as long as a server may prepare its scene, whatever it answers.
bool is_cut_off(const Client& client);
// Rows changed since the last call.
bool take_merged_rows(Client* client, std::uint32_t* row_begin, std::uint32_t* row_end);

// By the link's clock, but never less than before.
std::uint64_t client_now_ns(const Client& client);
// Of the current frame, its preparation included.
inline std::uint64_t client_elapsed_ns(const Client& client) {
  return client_now_ns(client) - client.begin_ns + client.prepare_ns;
}
// Where a row begins in client->pixels.
inline std::uint8_t* merged_row(const Client& client, std::uint32_t row) {
  return client.pixels.data + std::size_t(row) * client.settings.width * pixel_bytes(client.options.format);
}

}  // namespace pocketray
