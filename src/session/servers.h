// Render servers, as the commands and the viewer use them. A program that shares its frames holds a Servers, any other
// a null pointer. remote/client has the backend; a build without a network has none.
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

namespace pocketray {

constexpr double kBestShare = -1;
constexpr int kVerifyAuto = -1;

struct ServersOptions {
  std::vector<std::string> addresses;
  double device_share = kBestShare;
  int verify = kVerifyAuto;  // pixels of servers that are checked in a frame
  double price = 0, energy_pixel = 0, energy_byte = 0, cost_weight_ms = 0, cost_cap = 0;
};

struct OfferedScene {
  std::string name;
  std::uint32_t triangle_count;
  std::uint64_t byte_count;
};

struct ServersState {
  bool in_use = false;    // servers take part in frames, or could from the next on, or the device has no scene
  bool cut_off = false;   // a device without the scene has received no rows for a while
  bool disputed = false;  // two servers sent different pixels, and this device, without the scene, cannot judge them
  std::uint32_t rows_done = 0;  // of the frame under way
};

// The merged picture: rows without padding.
struct MergedPicture {
  const std::uint8_t* pixels;
  int line_bytes;
  PixelFormat format;
};

struct ServersTotals {
  std::uint64_t frames = 0, device_rows = 0, server_rows = 0, bytes_in = 0, bytes_out = 0;
  std::uint64_t checked = 0;  // of servers' pixels, or of their rows where the device has no scene
  std::uint32_t lies = 0;     // servers that sent wrong ones
  bool checks_rows = false;
  double caught_row = 0;              // least probability of noticing one wrong row per frame, over all servers
  double local_ns = 0, known_ns = 0;  // predicted for the device alone, and measured, of frames that had a prediction
};

using OutputBytes = std::function<std::size_t(const Settings&)>;

struct ServersBackend;
struct Servers {
  const ServersBackend* backend;
};

struct ServersBackend {
  // Resolves the addresses, which may take the system a while; *servers is null where there are none. `emulated`: the
  // device whose radio is emulated, or null.
  Status (*open)(const ServersOptions& options, const platform::Device* emulated, Servers** servers);
  void (*close)(Servers* servers);

  // Bytes of the frame arena.
  std::size_t (*need)(const Servers& servers, const Settings& settings);
  // Opens the scene, ready for rendering. One that is neither built in nor a file is fetched from the first server that
  // has it. One that does not fit the memory is left to the servers: the renderer then has room for pictures alone, and
  // opened->source.warning says how much memory would hold it.
  Status (*open_scene)(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                       OpenScene* opened);
  // From another thread: open_scene() may give up.
  void (*stop_opening)(Servers* servers);
  // Triangles of the scene that is open, wherever it is.
  std::uint32_t (*triangle_count)(const Servers& servers, const Renderer& renderer);
  // Scenes that a server offers; `server` is an index of ServersOptions::addresses.
  Status (*list_scenes)(Servers* servers, std::size_t server, std::vector<OfferedScene>* scenes);

  // With the scene open: ready for frames, which arrive as pixels of 24 bits, or of 16 where `small_pixels`.
  Status (*start)(Servers* servers, Renderer* renderer, bool small_pixels, bool dither);
  // A frame: begin, then advance until about `deadline_ns` by clock_ns(), until it is complete. begin_frame() gives up
  // a frame under way.
  Status (*begin_frame)(Servers* servers, Renderer* renderer, double seconds);
  bool (*advance_frame)(Servers* servers, Renderer* renderer, std::uint64_t deadline_ns, const std::atomic<bool>* stop);
  // Between frames: keeps connections and overtures going. Does not wait.
  void (*tend)(Servers* servers);
  ServersState (*state)(const Servers& servers);

  MergedPicture (*picture)(const Servers& servers);
  // Rows of the picture that have changed since the last call; false: none.
  bool (*take_rows)(Servers* servers, std::uint32_t* row_begin, std::uint32_t* row_end);
  // Copies the device's own picture, as far as it is rendered, into the merged one.
  void (*show_own_picture)(Servers* servers, const Renderer& renderer);

  // Who rendered what in the last complete frame, for people: rows, times, bytes, gain; or one line per server alone.
  void (*write_lines)(const Servers& servers, bool servers_only, HudText* text);
  ServersTotals (*totals)(const Servers& servers);
};

struct ServersCloser {
  void operator()(Servers* servers) const { servers->backend->close(servers); }
};
using ServersHandle = std::unique_ptr<Servers, ServersCloser>;

// The following take null, too: a device that renders alone.
Status open_scene_with(Servers* servers, const CommonOptions& common, const OutputBytes& output_bytes,
                       OpenScene* opened);
std::uint32_t triangle_count(const Servers* servers, const Renderer& renderer);

}  // namespace pocketray
