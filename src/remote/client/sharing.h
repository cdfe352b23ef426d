// Frames shared with render servers, as the commands use it. A build without a network has no_sharing.cpp in its place.
#pragma once
#include <string>
#include <vector>

#include "engine/renderer.h"
#include "platform/devices/device.h"
#include "present/hud_text.h"
#include "present/pack.h"
#include "session/open_scene.h"
#include "session/source.h"

namespace pocketray {

constexpr double kBestShare = -1;
constexpr int kVerifyAuto = -1;

struct SharingOptions {
  std::vector<std::string> servers;
  double device_share = kBestShare;
  int verify = kVerifyAuto;  // pixels of servers that are checked in a frame
  double price = 0, energy_pixel = 0, energy_byte = 0, cost_weight_ms = 0, cost_cap = 0;
};

struct Sharing;

struct OfferedScene {
  std::string name;
  std::uint32_t triangle_count;
  std::uint64_t byte_count;
};

// Finds the servers' addresses, which may take the system a while; *sharing is null where none was named. `emulated`:
// the device whose radio is to be emulated, or null.
Status open_sharing(const SharingOptions& options, const platform::Device* emulated, Sharing** sharing);
// Null is allowed, here and below where it says so.
void close_sharing(Sharing* sharing);

// What the frame arena must hold for it. Null: nothing.
std::size_t sharing_bytes(const Sharing* sharing, const Settings& settings);
// Opens the scene, ready for rendering. One that is neither built in nor a file is fetched from the first server that
// has it; one that does not fit the memory is left to the servers: the renderer then has room for pictures alone, and
// what it is that --memory would have to be stands in opened->source.warning. Null: the device has to have it, and the
// room.
Status open_shared_scene(Sharing* sharing, const CommonOptions& common,
                         const std::function<std::size_t(const Settings&)>& output_bytes, OpenScene* opened);
// From another thread: open_shared_scene() need not go on.
void stop_opening(Sharing* sharing);
// Triangles of the scene, which the renderer may not have.
std::uint32_t shared_triangle_count(const Sharing* sharing, const Renderer& renderer);

// What the servers offer, one after the other. `server` counts from 0 to as many as were named.
Status list_shared_scenes(Sharing* sharing, std::size_t server, std::vector<OfferedScene>* scenes);

// With the scene opened: ready for frames, which come as pixels of 24 bits, or of 16 where `small_pixels`.
Status start_sharing(Sharing* sharing, Renderer* renderer, bool small_pixels, bool dither);

// A frame: begin, then advance until about `deadline_ns` by clock_ns() until it is complete. A frame that was begun and
// not completed is given up by the next.
Status begin_shared(Sharing* sharing, Renderer* renderer, double seconds);
bool advance_shared(Sharing* sharing, Renderer* renderer, std::uint64_t deadline_ns, const std::atomic<bool>* stop);

// Whether a device that leaves all to the servers has had none for a while.
bool is_cut_off(const Sharing& sharing);
// Whether two servers sent different pixels, and this device, without the scene, cannot tell which are right.
bool is_disputed(const Sharing& sharing);
// Whether servers take part in frames, or could from the next on. With none in reach a picture that is refined shows
// sooner than one that is complete; a device that leaves all to the servers has no choice.
bool has_servers(const Sharing& sharing);
// Takes over the device's own picture as far as it is rendered: it stands until rows of the next frame come.
void show_own_picture(Sharing* sharing, const Renderer& renderer);
// While no frame that is shared is under way: connections and overtures go on. Does not wait.
void tend_servers(Sharing* sharing);

// The merged picture: rows without padding, the formats above. Its rows that changed since the last call.
struct SharedPicture {
  const std::uint8_t* pixels;
  int line_bytes;
  PixelFormat format;
};
SharedPicture shared_picture(const Sharing& sharing);
bool take_shared_rows(Sharing* sharing, std::uint32_t* row_begin, std::uint32_t* row_end);
std::uint32_t shared_rows_done(const Sharing& sharing);

// Who rendered what in the last complete frame, for people: rows, times, bytes, gain. Adds lines; no memory is taken.
void write_share_lines(const Sharing& sharing, HudText* text);
// Of those lines the ones about servers.
void write_server_lines(const Sharing& sharing, HudText* text);

struct ShareTotals {
  std::uint64_t frames = 0, device_rows = 0, server_rows = 0, bytes_in = 0, bytes_out = 0;
  std::uint64_t checked = 0;  // of servers' pixels, or of their rows where the device has no scene
  std::uint32_t lies = 0;     // servers that sent wrong ones
  bool checks_rows = false;
  double caught_row =
      0;  // had a server sent one wrong row in each frame: the probability that it was found; the least of all
  double local_ns = 0, known_ns = 0;  // predicted for the device alone, and measured, of frames that had a prediction
};
ShareTotals share_totals(const Sharing& sharing);

}  // namespace pocketray
