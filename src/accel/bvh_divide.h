// The upper levels of the BVH: ranges of many primitives are divided in two.
#pragma once
#include "accel/bvh_primitive.h"

namespace pocketray {

// A range of primitives that becomes a child.
struct BuildPart {
  std::uint32_t begin, count, leaf_max;  // leaf_max: budget of leaves
  WideBox box, centroids;                // of centroid2()
};

// Makes the part primitives[begin .. begin + count) and computes its boxes.
BuildPart make_part(const BuildPrimitive* primitives, std::uint32_t begin, std::uint32_t count, std::uint32_t leaf_max);

// Returns whether the part's centroids differ, so that some divisions are better than others.
bool has_division_axis(const BuildPart& part);

// Each side must be one leaf or at least four, so that nodes do not stay half empty.
constexpr std::uint32_t kSideLeavesMin = 4;
constexpr bool can_be_divided(std::uint32_t count) { return leaves_for(count) > kSideLeavesMin; }

// Divides a part by the surface-area heuristic, or with `halve` into equal counts; reorders its primitives.
void divide_part(BuildPrimitive* primitives, const BuildPart& part, bool halve, BuildPart* left, BuildPart* right);

}  // namespace pocketray
