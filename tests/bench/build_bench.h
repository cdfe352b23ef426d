// The cost of acceleration structures: build, memory, refit; gain by a second thread; our other accelerators; whole
// frames.
#pragma once
#include <string>
#include <vector>

#include "bench/embree_side.h"
#include "bench/ours.h"

namespace pocketray {

// One structure over one scene. Not measured: negative.
struct BuildRow {
  std::string scene, builder;  // "bvh" and our others, "embree robust medium" …
  std::uint32_t triangles = 0;
  double build_ms = -1;                 // CPU time of all threads, median
  double accel_bytes_per_triangle = 0;  // Embree's by its memory monitor
  double mesh_bytes_per_triangle = 0;   // positions and indices, in each side's layout
  double refit_ms = -1;                 // ours
  double two_threads = -1;              // primary rays per second of two threads against one, by CPU time
  double frame_ns_per_pixel = -1;       // CPU time of whole Whitted frames at 320×240; the default accelerator's
  double speed[3] = {-1, -1, -1};       // primary, shadow, bounce rays per second against our default
};

// Rows of all our accelerators except the oracle, the default first, then Embree's builds. `sets` are ray sets of the
// scene; the two threads divide the primary rays.
std::vector<BuildRow> bench_builds(BenchScene* scene, EmbreeSide* embree, const std::vector<RaySet>& sets, int rounds);

}  // namespace pocketray
