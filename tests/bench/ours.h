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

// hits[i] answers rays[i]: primary rays, whole tiles of them.
void trace_primary_ours(const OurSide& ours, const Ray* rays, std::size_t count, Hit* hits);

// What answers the set: `occluded` for shadow rays, else `hits`.
struct Answers {
  std::vector<Hit> hits;
  std::vector<unsigned char> occluded;
};
Answers room_for_answers(const RaySet& set);
void trace_ours(const OurSide& ours, const RaySet& set, Answers* answers);

}  // namespace pocketray
