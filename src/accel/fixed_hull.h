// The hull of rays of one class in fixed point: a shaft [Haines & Wallace 1994] between two planes across their
// dominant axis, by which the boxes of the BVH are tested for all of them at once. Part of the kernels: see
// bvh_fixed.h.
//
// The first plane lies where the first ray begins, the second where the last one ends; in each, the lines of the rays
// are bounded by a rectangle, and between the planes by the lines that connect the rectangles' sides. Beside the errors
// of rays and boxes (fixed_box.h), points of the planes err by another 3 units, and the slopes of middle and radius,
// divided as floats, by less than 2^-22 of the 2^29 that lie between the planes at most: kHullSlack covers them.
#pragma once
#include "accel/fixed_box.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr std::int32_t kHullSlack = 512;

// Along x or y, at depth z: middle + shear·z ± (radius + spread·z), where |shear| + |spread| = size ≤ 1.
struct HullSide {
  std::int32_t middle, shear, radius, spread, size;
};
struct FixedHull {
  std::int32_t z, length;  // the first plane, and the distance of the second
  HullSide x, y;
};

// An interval in each plane.
struct HullRange {
  static constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  std::int32_t near_low = kMost, near_high = -kMost, far_low = kMost, far_high = -kMost;
};
inline void widen(HullRange* r, std::int32_t near, std::int32_t far) {
  if (near < r->near_low) r->near_low = near;
  if (near > r->near_high) r->near_high = near;
  if (far < r->far_low) r->far_low = far;
  if (far > r->far_high) r->far_high = far;
}
inline void widen(HullRange* r, const HullRange& other) {
  widen(r, other.near_low, other.far_low), widen(r, other.near_high, other.far_high);
}

inline HullSide hull_side(const HullRange& r, float per_length) {
  std::int32_t near = (r.near_low + r.near_high) >> 1, far = (r.far_low >> 1) + (r.far_high >> 1);
  std::int32_t near_radius = ((r.near_high - r.near_low) >> 1) + 1;
  std::int32_t far_radius = (r.far_high >> 1) - (r.far_low >> 1) + 1;
  HullSide side;
  side.middle = near, side.radius = near_radius + kHullSlack;
  side.shear = to_fraction(static_cast<float>(far - near) * per_length);
  side.spread = to_fraction(static_cast<float>(far_radius - near_radius) * per_length);
  std::uint32_t size = magnitude(side.shear) + magnitude(side.spread);
  side.size = size > 0x7FFFFFFFu ? 0x7FFFFFFF : static_cast<std::int32_t>(size);
  return side;
}

// Returns whether all rays of the hull miss the box up to the depth `limit`; if not, *near receives the depth where the
// box begins. Depths count from the first plane.
template <class Slabs>
inline bool misses(const FixedHull& hull, const Slabs& slabs, std::int32_t limit, std::int32_t* near) {
  FixedSlab along = slabs.z();
  std::int32_t z = along.middle - hull.z;
  *near = z - along.half;
  if (*near > limit || z + along.half < 0) return true;
  auto beside = [&](const HullSide& side, const FixedSlab& slab) {
    std::int32_t at = slab.middle - side.middle - part(z, side.shear);
    std::int32_t reach = slab.half + side.radius + part(z, side.spread) + part(along.half, side.size);
    return at > reach || -at > reach;
  };
  return beside(hull.x, slabs.x()) || beside(hull.y, slabs.y());
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
