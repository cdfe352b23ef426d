// Our side of the comparison.
#pragma once
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "bench/bench_rays.h"

namespace pocketray {

// An accelerator over a scene, in its own block of exactly the planned size.
struct OurSide {
  const AccelInfo* info = nullptr;
  Accel accel;
  std::unique_ptr<unsigned char[]> block;  // holds the structure
};

OurSide build_ours(const BenchScene& scene, const AccelInfo* info);

// "sse2" limits our code to baseline x86-64, "native" lets it use all of this CPU.
void hold_ours(const std::string& isa);

// Rays in our best layout and their results, in the order of the ray set: occlusion_of() for shadow rays, else `hits`.
// The side and the set must outlive it.
struct OurTask {
  const OurSide* side;
  const RaySet* set;
  std::vector<RayPacket> packets;       // primary rays: one per tile
  std::vector<SegmentPacket> segments;  // shadow rays: one per tile
  std::vector<Hit> hits;
  std::vector<std::uint64_t> blocked;  // one bit per ray of the segments
};

std::vector<bool> occlusion_of(const OurTask& task);
OurTask make_our_task(const OurSide& side, const RaySet& set);
void trace_ours(OurTask* task);
// The tiles of primary rays from first to first + count − 1.
void trace_tiles_ours(OurTask* task, std::size_t first, std::size_t count);

}  // namespace pocketray
