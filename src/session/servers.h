// Render servers, as the commands and the viewer use them. Programs without servers hold a null pointer. remote/client
// has the backend; builds without a network have none.
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/renderer.h"
#include "platform/devices/device.h"
#include "present/hud_text.h"
#include "present/pack.h"
#include "session/open_scene.h"
#include "split/effect_choice.h"

namespace pocketray {

constexpr double kBestShare = -1;
constexpr int kVerifyAuto = -1;
constexpr std::uint32_t kLightEveryMax = 60;  // chosen: with more, light lags by seconds

struct ServersOptions {
  std::vector<std::string> addresses;
  std::string key;  // file of the key that encrypts the links; empty: unencrypted
  double device_share = kBestShare;
  int verify = kVerifyAuto;       // number of servers' pixels to check per frame
  bool coarse_first = false;      // long frames begin with a coarse picture
  bool near_lossless = false;     // servers' pixels may be off by one level per channel
  std::string split = "rows";     // rows, effect or auto
  std::uint32_t light_every = 1;  // frames of a moving view per map
  double price = 0, energy_pixel = 0, energy_byte = 0, cost_weight_ms = 0, cost_cap = 0;
};

struct OfferedScene {
  std::string name;
  std::uint32_t triangle_count;
  std::uint64_t byte_count;
};

struct ServersState {
  bool in_use = false;    // servers render parts of frames, or can from the next frame on, or the device has no scene
  bool cut_off = false;   // no rows for a while, on a device without the scene
  bool disputed = false;  // two servers sent different pixels, and this device has no scene to judge by
  std::uint32_t rows_done = 0;  // of the current frame
  double left_ns = 0;           // estimated time until it is complete; 0: it is
  double anew_ns = 0;           // time until one begun now would be, or its coarse picture; 0: unknown
  bool coarse_shown = false;    // every row of the picture belongs to the current frame, many of them coarse
};

// The merged picture: rows without padding.
struct MergedPicture {
  const std::uint8_t* pixels;
  int line_bytes;
  PixelFormat format;
};

struct ServersTotals {
  std::uint64_t frames = 0, device_rows = 0, server_rows = 0, bytes_in = 0, bytes_out = 0;
  std::uint64_t device_pixels = 0;     // traced in the device's rows
  std::uint64_t unchanged_frames = 0;  // equal to the previous frame: nothing was requested
  std::uint64_t checked = 0;           // servers' pixels checked, or rows if the device has no scene
  std::uint32_t lies = 0;              // servers caught with wrong pixels
  std::uint64_t effect_frames = 0, lit_frames = 0, light_bytes = 0;  // shared by effect, with light, and its bytes
  double effect_ns = 0, rows_ns = 0;  // last expected time of a frame by either way; 0: unknown
  EffectTimes effect_times;           // of frames by effect
  bool checks_rows = false;
  double caught_row = 0;              // lowest probability of catching one wrong row per frame, over all servers
  double local_ns = 0, known_ns = 0;  // predicted for the device alone, and measured; only frames with a prediction
};

using OutputBytes = std::function<std::size_t(const Settings&)>;

struct ServersBackend;
struct Servers {
  const ServersBackend* backend;
};

struct ServersBackend {
  // Resolves the addresses, which may take a while; *servers is null if there are none. `emulated`: the device whose
  // radio to emulate, or null.
  Status (*open)(const ServersOptions& options, const platform::Device* emulated, Servers** servers);
  void (*close)(Servers* servers);

  // Bytes of the frame arena.
  std::size_t (*need)(const Servers& servers, const Settings& settings);
  // Opens the scene, ready for rendering. If it is neither built in nor a file, fetches it from the first server that
  // has it. If it does not fit in memory, leaves it to the servers: the renderer then has room only for pictures, and
  // opened->source.warning says how much memory the scene needs.
  Status (*open_scene)(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                       OpenScene* opened);
  // Call from another thread to make open_scene() give up.
  void (*stop_opening)(Servers* servers);
  // Triangles of the open scene, here or on servers.
  std::uint32_t (*triangle_count)(const Servers& servers, const Renderer& renderer);
  // Scenes that a server offers; `server` is an index into ServersOptions::addresses.
  Status (*list_scenes)(Servers* servers, std::size_t server, std::vector<OfferedScene>* scenes);

  // Prepares the open scene for frames; pixels arrive with 24 bits, or 16 if `small_pixels`.
  Status (*start)(Servers* servers, Renderer* renderer, bool small_pixels, bool dither);
  // Ends what start() began, if anything. Call before the renderer's memory is given back, or close().
  void (*stop)(Servers* servers);
  // Begin a frame, then advance it, each time for about `slice_ns`, until it is complete. begin_frame() abandons an
  // unfinished frame.
  Status (*begin_frame)(Servers* servers, Renderer* renderer, double seconds);
  bool (*advance_frame)(Servers* servers, Renderer* renderer, std::uint64_t slice_ns, const std::atomic<bool>* stop);
  // Call between frames: keeps connections and overtures going. Never blocks.
  void (*tend)(Servers* servers);
  ServersState (*state)(const Servers& servers);

  MergedPicture (*picture)(const Servers& servers);
  // Returns the rows of the picture changed since the last call; false if none.
  bool (*take_rows)(Servers* servers, std::uint32_t* row_begin, std::uint32_t* row_end);
  // Copies the finished part of the device's own picture into the merged one.
  void (*show_own_picture)(Servers* servers, const Renderer& renderer);

  // Describes the last complete frame: rows, times, bytes and gain per server; or only one line per server.
  void (*write_lines)(const Servers& servers, bool servers_only, HudText* text);
  ServersTotals (*totals)(const Servers& servers);
};

struct ServersCloser {
  void operator()(Servers* servers) const { servers->backend->close(servers); }
};
using ServersHandle = std::unique_ptr<Servers, ServersCloser>;

// These also accept null: no render servers.
Status open_scene_with(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                       OpenScene* opened);
std::uint32_t triangle_count(const Servers* servers, const Renderer& renderer);

}  // namespace pocketray
