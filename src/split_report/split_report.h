// What the split of a scene's frames gains: frame time over the device's share m, the share that the program chooses,
// and Table 1 of [Aranha07] with the paper's own times. Real pixels, rows and messages in a simulated world: an
// emulated pixel costs what it is said to cost, whatever this machine is doing meanwhile.
#pragma once
#include <vector>

#include "remote/client/client.h"
#include "session/progress.h"
#include "split_report/virtual_world.h"

namespace pocketray {

struct SplitSetup {
  Renderer* device = nullptr;         // built; its own pace is not used
  const SceneStore* store = nullptr;  // has the scene
  ContentHash scene;
  WireFormat format = WireFormat::rgb888;
  platform::NullLinkSettings line;
  std::uint32_t server_count = 1;
  double device_ns = 0, server_ns = 0;  // what a pixel costs the device, and each server
  float orbit_degrees = 1;              // that the camera goes on around its target in a frame; 0: it stands
  std::uint32_t frame_count = 8;        // of the path that is measured for each share
};

// Frames with a share; means but where something else is said.
struct SplitPoint {
  double m = 0;                              // the device's share of the rows
  double ns_per_pixel = 0;                   // of the median frame
  double bytes = 0;                          // received and sent per frame
  double row_bytes = 0;                      // of them, the rows without their messages
  double row_count = 0;                      // that servers sent
  double server_rows[kServerCountMax] = {};  // of them, each server's
};

struct PaperRow {
  const char* scene;  // of the paper, whose times these are; rendered is the report's own
  int processors;
  double server_ns, device_ns;               // T_s and T_m
  double share, ns_per_pixel;                // as printed in Table 1
  double our_share = 0, our_ns = 0;          // 0: not measured
  double bound_ns = 0, bytes_per_pixel = 0;  // what full overlap allows; as the rows compress
};

struct SplitFigures {
  SplitPoint chosen, best, local;  // the program's; the least of the sweep; the device alone
  std::vector<SplitPoint> sweep;   // by m
  double whole_bytes = 0;          // of a frame whose every row is sent anew, compressed as the chosen ones
  std::vector<PaperRow> paper;
};

// Frames that measure_split() and measure_paper() take, about: the total of their progress.
std::uint64_t split_frame_count(const SplitSetup& setup, std::uint32_t step_count);
std::uint64_t paper_frame_count(const SplitSetup& setup);

// The chosen split first, then m = 1, m = 0 and those between, `step_count` in all, and a few more around the least. An
// interrupt keeps the points that are finished; sweep is empty where there is none.
Status measure_split(const SplitSetup& setup, std::uint32_t step_count, Progress* progress, SplitFigures* figures);
// Table 1 of [Aranha07] with the paper's T_m and T_s, and T_t = 400 ns a pixel as the rows of this scene compress, by
// a link that is as fast as that takes and has no latency, since the paper names none.
Status measure_paper(const SplitSetup& setup, Progress* progress, SplitFigures* figures);

}  // namespace pocketray
