// Client: the device's side of the split ([Aranha07] sec. 3.2-3.3). It keeps a connection to each render server,
// measures server and link in an overture, requests rows of each frame and merges them with the device's own. A late or
// lost server costs time but no pixel. Spot checks (client/verify.h) find servers that send wrong pixels, with a known
// probability; earlier pixels of such a server may have been shown. All memory is in one arena, time is the link's, and
// only link polling blocks.
#pragma once
#include "engine/pace.h"
#include "engine/renderer.h"
#include "remote/client/light.h"
#include "remote/client/remote_server.h"
#include "split/cost_model.h"
#include "split/merge.h"
#include "wire/code_cost.h"

namespace pocketray {

// Rows per chunk that a server sends: at most at the ends of a frame and in its middle, and throughout if no order is
// requested. Larger chunks need fewer headers and compress better, smaller ones arrive sooner; tuned with split-report.
constexpr std::uint32_t kChunkRowsMin = 2, kChunkRowsMax = 32, kChunkRowsEven = 8;

struct ClientOptions {
  WireFormat format = WireFormat::rgb888;
  bool dither = false;
  SplitWish wish;
  double cost_per_device_pixel = 0, cost_per_byte = 0;  // energy, in the unit of the cost cap
  double cost_per_megabyte = 0;                         // price of 10⁶ bytes
  double device_share = -1;                             // in [0, 1]: a fixed m, for comparisons; negative: the optimum
  bool near_lossless = false;                           // servers' pixels may be off by a level per channel
  double coarse_after_ns = 0;                           // frames that take longer begin with a coarse picture; 0: none
  bool device_goes_on = true;                           // continues into missing rows; false: for comparisons
  Pace pace;                                            // the CPU to emulate
  double own_light_pixel_ns = 0;                        // like pace.ns_per_pixel, for frames shared by effect; 0: equal
  CodeCost decode;                                      // emulated cost of decoding; 0: the host's
  LightOptions light;                                   // of frames shared by effect
  const float* row_costs = nullptr;                     // relative row costs on the device; see row_costs.h
  bool has_scene = true;                                // false: the device only shows what servers render
  int check_count = kCheckCountAuto;  // servers' pixels to check per frame, at most kSpotChecksMax; 0: none
  // Random bytes that no server can predict, as in platform/entropy.h; null: a fixed sequence, for tests.
  bool (*entropy)(void* bytes, std::size_t byte_count) = nullptr;
  // Chosen: TCP repeats a lost packet after 1 s [RFC 6298, sec. 2], so 3 s outlast one loss; the device renders
  // meanwhile. A server that fails is retried after half a second, then after twice that and so on: soon after a short
  // fault, and rarely enough to cost nothing if it lasts.
  std::uint64_t connect_timeout_ns = 3'000'000'000;
  std::uint64_t silence_timeout_ns = 3'000'000'000;   // without a complete answer
  std::uint64_t prepare_timeout_ns = 30'000'000'000;  // until the first rows, since the server builds its scene first;
                                                      // and for light, even if the server answers pings
  std::uint64_t retry_ns_min = 500'000'000, retry_ns_max = 30'000'000'000;
  void (*log)(void* context, const char* line) = nullptr;  // writes one line when a server is lost or back
  void* log_context = nullptr;
};

// Summary of a finished frame, for users and the report.
struct FrameShare {
  std::uint32_t frame = 0;
  double predicted_ns = 0;                          // by the chosen split; 0: unknown
  bool unchanged = false;                           // equals the last frame, whose rows are kept
  double measured_ns = 0;                           // from its start to its completion
  double local_ns = 0;                              // predicted for the device alone; 0: unknown
  std::uint32_t device_rows = 0;                    // rendered by the device
  std::uint64_t device_pixels = 0;                  // traced for them
  std::uint32_t server_rows[kServerCountMax] = {};  // rendered by each server
  std::uint32_t row_begin[kServerCountMax] = {}, row_end[kServerCountMax] = {};  // requested from each
  std::uint64_t server_bytes[kServerCountMax] = {};                              // received from each
  std::uint32_t checked[kServerCountMax] = {};  // pixels checked; rows if the device has no scene
  std::uint32_t lies = 0;                       // servers caught with wrong pixels
  std::uint64_t row_bytes = 0;                  // bytes of received rows without message overhead
  std::uint32_t kept_rows = 0;                  // rows received in chunks of which the server traced nothing,
  std::uint64_t kept_bytes = 0;                 // and all bytes of these chunks
  std::uint64_t bytes_in = 0, bytes_out = 0;    // on the wire, all connections
  bool by_effect = false;                       // a server rendered the indirect light of the device's rows,
  bool has_light = false;                       // which include it,
  std::uint32_t light_age = 0;                  // rendered this many frames before,
  std::uint64_t light_bytes = 0;                // of maps that came during the frame
};

// Arrival of a frame's rows, from the first chunk, whose start is unknown, to the last.
struct Arrivals {
  std::uint64_t asked_ns = 0;                          // when rows could first be requested
  std::uint64_t first_ns = 0, last_ns = 0, bytes = 0;  // bytes: of the chunks after the first
  std::uint64_t gap_ns_max = 0;                        // longest gap between two polls of the link
};

// Experiments that assume a link limiting the split to be faster, since servers may not share it at all.
struct LinkTrial {
  bool limited = false;                     // the link limits the frame's split
  float before = 0;                         // its time per byte before the current trial; 0: none
  std::uint64_t rest = 1, rests_until = 0;  // in frames with servers; the rest doubles with each failed trial
};

// A row that the device renders in parts because it takes longer than the interval between polls.
struct DeviceRow {
  bool in_parts = false;  // such a row is in progress
  std::uint32_t row = 0, columns_done = 0;
  double pixel_ns = 0;        // of the last part or of earlier rows; 0: unknown
  std::uint64_t took_ns = 0;  // so far
};

// The split of frames, learnt from earlier ones.
struct SplitPlan {
  CostModel model;
  SplitWorkspace workspace;
  Split split;
  LinkTrial link_trial;
  std::uint64_t frames_with_servers = 0;  // since a server came into use
  Smoothed decode_ns, code_saves;         // per coded pixel: time to decode it; bytes that coding saves
};

// The current frame.
struct ClientFrame {
  FrameRequest request;
  bool complete = true, joined = false;
  bool held = false;  // requests wait until a link is measured
  std::uint64_t begin_ns = 0, waited_ns = 0, looked_ns = 0;
  double alone_ns = 0;           // predicted for the device without servers, rendering its rows of the frame likewise
  bool prepared = false;         // the device can trace its pixels,
  std::uint64_t prepare_ns = 0;  // after this long
  bool unchanged = false;        // it equals the last one: nothing is requested
  Arrivals arrivals;
  DeviceRow device_row;
  double device_ns = 0;             // spent on the device's own rows
  std::uint64_t device_pixels = 0;  // traced for them
  std::uint64_t progress_ns = 0;    // when missing rows last came
  std::uint64_t bytes_in_before = 0, bytes_out_before = 0;
};

// Its coarse picture.
struct ClientCoarse {
  bool asked = false;    // a server was asked to send it first
  bool shown = false;    // it is shown in the rows that were missing when it came,
  std::uint64_t ns = 0;  // this long after the start of the frame
};

// The merged frame.
struct MergedFrame {
  Merge merge;
  Array<std::uint8_t> pixels;                    // in the wire's format, rows without padding
  std::uint64_t kept_count = 0;                  // of the device's coherence: the frame that `pixels` show; 0: unknown
  std::uint32_t dirty_begin = 0, dirty_end = 0;  // rows changed since take_merged_rows()
};

struct Client {
  ClientOptions options;
  platform::Link* link = nullptr;
  Settings settings;
  ContentHash scene;
  std::uint32_t server_count = 0;
  RemoteServer servers[kServerCountMax];
  SplitPlan plan;
  ClientFrame frame;
  ClientCoarse coarse;
  MergedFrame picture;
  Verifier verifier;
  ClientLight light;
  mutable platform::LinkClock clock;
  std::uint64_t unwatched_ns = 0;  // time before the latest poll: input may have arrived that much earlier
  FrameShare share;                // of the last complete frame
};

// Order and coding of rows for a link of this speed, where coding pays above `threshold` nanoseconds per byte.
RowCoding row_coding(double ns_per_byte, double threshold, bool near_lossless);
// This threshold for a server, from decoding times and savings on this device; close to it, the coding stays unchanged.
double code_threshold(const Client& client, const RemoteServer& server);

// Arena bytes for pictures of that size. The client uses server_count streams of the link.
std::size_t client_need(const Settings& settings, WireFormat format, std::uint32_t server_count,
                        const LightOptions& light = LightOptions());
// Addresses must be resolved; does not connect yet. The client must not be moved.
Status make_client(const ClientOptions& options, const Settings& settings, const ContentHash& scene,
                   platform::Link* link, const platform::LinkAddress* servers, std::uint32_t server_count, Arena* arena,
                   Client* client);
// Says goodbye and closes the connections.
void close_client(Client* client);

// Advances connections, overtures and arriving rows; blocks for at most `timeout_ns`.
void advance_client(Client* client, std::uint64_t timeout_ns);

// State of a frame when rows of it are requested.
struct FrameStart {
  double seconds = 0;            // animation time
  std::uint64_t begin_ns = 0;    // when its input was known, by client_now_ns()
  bool prepared = false;         // the renderer is; otherwise it has camera and exposure, and device_is_ready() follows
  std::uint64_t prepare_ns = 0;  // time taken by that
  bool unchanged = false;        // its pixels equal those of the last frame
};
// Begins a frame: plans the split and requests the servers' rows. Abandons an unfinished frame.
void begin_client_frame(Client* client, const Renderer& renderer, const FrameStart& start);
// True while the device has rows to render: its own, or servers' rows that are not worth waiting for.
bool has_device_rows(const Client& client);
// Call when the renderer of the current frame has been prepared, which took `prepare_ns`.
void device_is_ready(Client* client, std::uint64_t prepare_ns);
// Takes the rows that the device must render next, at most `row_count_max`; returns false if there are none.
bool take_device_rows(Client* client, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end);
// Call when the device has rendered them in `ns` of wall-clock time into client->pixels.
void finish_device_rows(Client* client, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t ns,
                        std::uint64_t pixel_count);
// Learns from the frame's measurements and lets servers drop the rest of it. Call once, when all rows are complete.
void end_client_frame(Client* client);

// True if the frame has all its rows.
inline bool has_all_rows(const Client& client) { return is_complete(client.picture.merge); }
// Longest work between polls of the link; shorter while an answer is timed.
double work_ns_max(const Client& client);
// True if every server is in use or waits for its next attempt after a logged failure. Of servers that only send light,
// one is in use and the others are ready to follow it.
bool is_settled(const Client& client);
// True if a device without the scene should give up: for five seconds no row has come and no server with requests has
// answered a ping, or no row has come for as long as a server may take to prepare its scene.
bool is_cut_off(const Client& client);
// Returns the rows changed since the last call.
bool take_merged_rows(Client* client, std::uint32_t* row_begin, std::uint32_t* row_end);

// The link's clock, made monotonic.
std::uint64_t client_now_ns(const Client& client);
// Time since the start of the current frame.
inline std::uint64_t client_elapsed_ns(const Client& client) { return client_now_ns(client) - client.frame.begin_ns; }
// Levels by which an honest server's channels may be off.
inline std::uint32_t pixel_tolerance(const Client& client) { return client.options.near_lossless ? 1 : 0; }
// Start of a row in client->pixels.
inline std::uint8_t* merged_row(const Client& client, std::uint32_t row) {
  return client.picture.pixels.data + std::size_t(row) * client.settings.width * pixel_bytes(client.options.format);
}

}  // namespace pocketray
