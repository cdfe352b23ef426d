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
  std::unique_ptr<unsigned char[]> keep_block, scratch_block;
};

OurSide build_ours(const BenchScene& scene, const AccelInfo* info);

// "sse2" holds our code to what every x86-64 has, "native" lets it use what this CPU has.
void hold_ours(const std::string& isa);

// hits[i] answers set.rays[i]. The set's rays are primary rays.
void trace_primary_ours(const OurSide& ours, const RaySet& set, std::vector<Hit>* hits);
void trace_bounce_ours(const OurSide& ours, const RaySet& set, std::vector<Hit>* hits);
void trace_shadow_ours(const OurSide& ours, const RaySet& set, std::vector<unsigned char>* occluded);

}  // namespace pocketray
