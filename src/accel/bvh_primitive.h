// Primitives of the BVH builder: boxes of triangles, in the lanes of a vector.
#pragma once
#include "accel/bvh.h"
#include "base/simd.h"

namespace pocketray {

// A triangle's box. The fourth lanes take part in the arithmetic without meaning: tagged ids are floats of ordinary
// magnitude.
struct alignas(16) BuildPrimitive {
  float low[3];
  std::uint32_t tagged_id;
  float high[3];
  float unused;  // 0
};
static_assert(sizeof(BuildPrimitive) == 32, "two vectors");
constexpr std::uint32_t kIdTag = 0x40000000;
static_assert(kTriangleCountMax <= 1u << 26, "tagged ids are floats from 2 to 512");

inline std::uint32_t triangle_of(const BuildPrimitive& p) { return p.tagged_id - kIdTag; }

// Box of primitives or of their centroids; three lanes count.
struct WideBox {
  Float4 low, high;
};
inline WideBox empty_wide_box() {
  constexpr float inf = std::numeric_limits<float>::infinity();
  return {Float4::splat(inf), Float4::splat(-inf)};
}
inline WideBox wide_box(const BuildPrimitive& p) { return {Float4::load(p.low), Float4::load(p.high)}; }
inline WideBox merge(const WideBox& a, const WideBox& b) { return {min(a.low, b.low), max(a.high, b.high)}; }

// Twice the centroid: precise enough to sort by, and finite.
inline Float4 centroid2(const WideBox& box) { return box.low + box.high; }
inline float centroid2(const BuildPrimitive& p, int axis) { return p.low[axis] + p.high[axis]; }

// Half the surface area. In double it neither overflows nor underflows for any float coordinates.
inline double half_area(const WideBox& box) {
  alignas(16) float low[4], high[4];
  store(low, box.low), store(high, box.high);
  double x = double(high[0]) - low[0], y = double(high[1]) - low[1], z = double(high[2]) - low[2];
  return x * y + y * z + z * x;
}

constexpr std::uint32_t leaves_for(std::uint32_t triangles) { return (triangles + kBvhLeafSize - 1) / kBvhLeafSize; }

// Cost of a part by the surface-area heuristic, in leaves.
inline double part_cost(const WideBox& box, std::uint32_t triangles) { return half_area(box) * leaves_for(triangles); }

}  // namespace pocketray
