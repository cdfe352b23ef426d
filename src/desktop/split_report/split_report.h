// Measures what a split gains: frame time over the device's share m, the share that the program chooses, and Table 1 of
// [Aranha07] with the paper's times. Pixels, rows and messages are real but time is simulated: an emulated pixel takes
// its stated time however busy this machine is.
#pragma once
#include <vector>

#include "desktop/split_report/virtual_world.h"
#include "engine/prepare_cost.h"
#include "remote/client/client.h"
#include "session/progress.h"

namespace pocketray {

// Costs of a server. Measured on one core of an AMD EPYC: frames of cornell and statue in both formats (test_wire
// -tc="codec_*").
constexpr CodeCost kServerEncode = {9, 160};
constexpr PrepareCost kServerPrepare = {75, 24};  // as on the desktop (platform/devices)

struct SplitSetup {
  Renderer* device = nullptr;         // built; its own pace is ignored
  const SceneStore* store = nullptr;  // holds the scene
  ContentHash scene;
  WireFormat format = WireFormat::rgb888;
  platform::NullLinkSettings line;
  std::uint32_t server_count = 1;
  double device_ns = 0, server_ns = 0;                  // time per pixel on the device and on each server
  double own_light_ns = 0;                              // like device_ns, in frames shared by effect; 0: none
  double device_prepare_ns = 0, server_prepare_ns = 0;  // time before a frame's first pixel
  CodeCost decode, encode;                              // for rows on the device and on each server
  float orbit_degrees = 1;                              // camera orbit per frame; 0: it stands still
  std::uint32_t frame_count = 8;                        // frames in the path measured for each share
};

// Figures of a share; means over frames unless stated otherwise.
struct SplitPoint {
  double m = 0;                              // the device's share of the rows
  double ns_per_pixel = 0;                   // of the median frame
  double device_pixels = 0;                  // traced by the device
  double prepared = 0;                       // fraction of frames that the device prepared
  double bytes = 0;                          // received and sent per frame
  double row_bytes = 0;                      // of these, rows without message overhead
  double row_count = 0;                      // sent by servers
  double kept_rows = 0, kept_bytes = 0;      // of these, in chunks in which nothing was traced; their bytes
  double server_rows[kServerCountMax] = {};  // of these, by server
  double by_effect = 0, light_bytes = 0;     // fraction of frames shared by effect; bytes of light
};

// A way to have light from a server (--split effect).
struct LightMapPoint {
  std::uint32_t every = 0;                   // frames per map; 0: no server
  double ns_per_pixel = 0, light_bytes = 0;  // of the median frame; of the mean frame
  double flip = 0;                           // mean over frames, against the device alone with that light
};

struct PaperRow {
  const char* scene;  // the paper's scene, for its times; the rendered scene is the report's
  int processors;
  double server_ns, device_ns;               // T_s and T_m
  double share, ns_per_pixel;                // as printed in Table 1
  double our_share = 0, our_ns = 0;          // 0: not measured
  double bound_ns = 0, bytes_per_pixel = 0;  // bound with full overlap; as the rows compress
};

struct SplitFigures {
  SplitPoint chosen, best, local;  // the program's choice; the sweep's minimum; the device alone
  SplitPoint effect, both;         // shared by effect; whichever of rows, effect or both is chosen
  std::vector<SplitPoint> sweep;   // by m
  double whole_bytes = 0;          // bytes of a frame as a connection's first
  // Bytes of a frame, all rows, after its predecessor; error of `near`: root mean square, in levels of the format.
  double lossless_bytes = 0, near_bytes = 0, near_error = 0;
  std::vector<LightMapPoint> light;  // the device's own light first
  std::vector<PaperRow> paper;
};

// Estimated number of frames that measure_split() and measure_paper() render: the total for their progress.
std::uint64_t split_frame_count(const SplitSetup& setup, std::uint32_t step_count);
std::uint64_t paper_frame_count(const SplitSetup& setup);

// Measures the chosen split first, then m = 1, m = 0 and points between, `step_count` in total, and a few more around
// the minimum. An interrupt keeps finished points; if there are none, sweep is empty.
Status measure_split(const SplitSetup& setup, std::uint32_t step_count, Progress* progress, SplitFigures* figures);
// Measures frames shared by effect, and by whichever way is chosen, as `render --split effect` and `auto` do.
std::uint64_t effect_frame_count(const SplitSetup& setup);
Status measure_effects(const SplitSetup& setup, Progress* progress, SplitFigures* figures);
// Measures frames shared by effect, with a map for each frame or for several: what that saves and how different the
// frames look. An interrupt keeps finished points.
std::uint64_t light_frame_count(const SplitSetup& setup);
Status measure_light(const SplitSetup& setup, Progress* progress, SplitFigures* figures);
// Measures Table 1 of [Aranha07] with the paper's T_m and T_s, and T_t = 400 ns per pixel for this scene's compressed
// rows: this determines the link's bandwidth, without latency, since the paper states none. Frames are traced whole,
// whatever the device's coherence.
Status measure_paper(const SplitSetup& setup, Progress* progress, SplitFigures* figures);

}  // namespace pocketray
