// A ray in fixed point against boxes. Part of the kernels: see bvh_fixed.h.
//
// A box is missed if the ray misses it along z, or its line as seen along x, y or z: by separating axes, without a
// division. Boxes are widened by 2^10 units, which exceeds the errors here (box 1, ray 5, two more products 4; the hull
// of fixed_hull.h has its own) and the 6u R by which cross_triangle() accepts hits of rays that miss the triangle,
// R < 2^29 (box_ray.h): 192; t rounds by another 32.
#pragma once
#include "accel/fixed_ray.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr std::int32_t kBoxSlack = 1 << 10;

// An interval along one axis.
struct FixedSlab {
  std::int32_t middle, half;
};
struct FixedBox {
  FixedSlab z, x, y;
};

inline FixedSlab child_slab(const BvhNode& node, int lane, int axis, const FixedFrame& frame) {
  std::int32_t low = to_fixed(node.bounds[axis][lane], frame.exponent) - 1;
  std::int32_t high = to_fixed(node.bounds[3 + axis][lane], frame.exponent) + 1;
  return {(low + high) >> 1, ((high - low) >> 1) + 1 + kBoxSlack};
}

// Slabs of a child, each converted on first use and kept in `box`.
struct ChildSlabs {
  const BvhNode& node;
  int lane;
  const FixedFrame& frame;
  FixedBox* box;

  FixedSlab z() const {
    box->z = child_slab(node, lane, frame.axes->z, frame);
    box->z.middle ^= frame.flip;
    return box->z;
  }
  FixedSlab x() const { return box->x = child_slab(node, lane, frame.axes->x, frame); }
  FixedSlab y() const { return box->y = child_slab(node, lane, frame.axes->y, frame); }
};
struct KeptSlabs {
  const FixedBox& box;
  FixedSlab z() const { return box.z; }
  FixedSlab x() const { return box.x; }
  FixedSlab y() const { return box.y; }
};

// Returns whether the ray misses the box up to depth `limit`; if not, *near receives the depth where it begins.
template <class Slabs>
inline bool misses(const FixedRay& ray, const Slabs& slabs, std::int32_t limit, std::int32_t* near) {
  FixedSlab along = slabs.z();
  std::int32_t z = along.middle - ray.z;
  *near = z - along.half;
  if (*near > limit || z + along.half < 0) return true;
  FixedSlab wide = slabs.x();
  std::int32_t x = wide.middle - ray.x - part(z, ray.shear_x), reach_x = wide.half + part(along.half, ray.size_x);
  if (x > reach_x || -x > reach_x) return true;
  FixedSlab high = slabs.y();
  std::int32_t y = high.middle - ray.y - part(z, ray.shear_y), reach_y = high.half + part(along.half, ray.size_y);
  if (y > reach_y || -y > reach_y) return true;
  std::int64_t across = product(x, ray.shear_y) - product(y, ray.shear_x);
  std::int64_t reach = product(wide.half, ray.size_y) + product(high.half, ray.size_x);
  return across > reach || -across > reach;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
