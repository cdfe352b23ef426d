// Our side of the comparison.
#pragma once
#include <memory>
#include <vector>

#include "accel/accel.h"
#include "bench/bench_rays.h"

namespace pocketray {

// An accelerator over a scene, with memory of its own of exactly the planned size.
struct OurSide {
  const AccelInfo* info = nullptr;
  Accel accel;
  std::unique_ptr<unsigned char[]> block;  // holds the structure
};

OurSide build_ours(const BenchScene& scene, const AccelInfo* info);

// "sse2" holds our code to what every x86-64 has, "native" lets it use what this CPU has.
void hold_ours(const std::string& isa);

// Rays in the layout that we like best, and what answers them, in the order of the ray set: occlusion_of() for
// shadow rays, else `hits`. The side and the set must outlive it.
struct OurTask {
  const OurSide* side;
  const RaySet* set;
  std::vector<RayPacket> packets;       // primary rays: a tile each
  std::vector<SegmentPacket> segments;  // shadow rays: those of a tile each
  std::vector<Hit> hits;
  std::vector<std::uint64_t> blocked;  // a bit for each ray of the segments
};

std::vector<bool> occlusion_of(const OurTask& task);
OurTask make_our_task(const OurSide& side, const RaySet& set);
void trace_ours(OurTask* task);
// The tiles of primary rays from first to first + count − 1.
void trace_tiles_ours(OurTask* task, std::size_t first, std::size_t count);

}  // namespace pocketray
