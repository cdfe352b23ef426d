// Both sides trace the same rays in turn on one thread: ours, Embree, ours, Embree's next mode, ours …, every round. A
// ratio is Embree's time over the mean of ours before and after it, so drift of the machine cancels. Time is CPU time
// of the thread, so that other programs disturb little. Rays are prepared outside the timing, in the best layout for
// each side; tracing them and writing t, u, v and triangle (or the occlusion) of each ray is timed.
#pragma once
#include <string>
#include <vector>

#include "bench/embree_side.h"
#include "bench/ours.h"

namespace pocketray {

struct DuelRow {
  std::string scene, rays, size, isa, embree_mode;
  double ours_mrays, embree_mrays;      // medians, million rays per second
  double ratio, ratio_low, ratio_high;  // ours/Embree: median, 10th and 90th percentile
  double differing_share;               // share of rays with different hits
};

// t within this of each other, relatively, is the same hit; at most this share of rays may differ. They are rays that
// graze an edge, where the two round differently, and rays that leak between two triangles in Embree's fast mode.
constexpr float kSameHit = 1e-4f;
constexpr double kDifferingShareMax = 1e-3;

// One row per mode.
std::vector<DuelRow> duel(const BenchScene& scene, const std::string& isa, const OurSide& ours, EmbreeSide* embree,
                          const RaySet& set, int rounds);

}  // namespace pocketray
