// The upper end of the BVH: ranges of many primitives are divided in two.
#pragma once
#include "accel/bvh_primitive.h"

namespace pocketray {

// A range of the primitives that becomes a child.
struct BuildPart {
  std::uint32_t begin, count, leaf_max;  // leaf_max: leaves that it may take
  WideBox box, centroids;                // of centroid2()
};

// The part of primitives[begin .. begin + count); measures its boxes.
BuildPart make_part(const BuildPrimitive* primitives, std::uint32_t begin, std::uint32_t count, std::uint32_t leaf_max);

// Whether centroids tell primitives of the part apart, so that one division is better than another.
bool has_division_axis(const BuildPart& part);

// Whether divide_part() finds a division: both sides have to be one leaf or at least four, lest nodes stay half empty.
constexpr std::uint32_t kSideLeavesMin = 4;
constexpr bool can_be_divided(std::uint32_t count) { return leaves_for(count) > kSideLeavesMin; }

// Splits a part that can be by the surface-area heuristic, or with `halve` into equal counts; reorders its primitives.
void divide_part(BuildPrimitive* primitives, const BuildPart& part, bool halve, BuildPart* left, BuildPart* right);

}  // namespace pocketray
