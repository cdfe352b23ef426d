// A ray in fixed point against the boxes of four children. Part of the kernels: see bvh_fixed.h.
//
// A box is missed if the ray misses it along z, or its line as seen along x, y or z: by separating axes, without a
// division. Boxes are widened by 2^10 units, which exceeds the errors here (box 1, ray 5, two more products 4) and the
// 6u R by which cross_triangle() accepts hits of rays that miss the triangle, R < 2^29 (box_ray.h): 192; t rounds by
// another 32.
#pragma once
#include "accel/fixed_ray.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr std::int32_t kBoxSlack = 1 << 10;

// Middle and half size by z, x, y.
struct FixedBox {
  std::int32_t z, half_z, x, half_x, y, half_y;
};
struct FixedNode {
  FixedBox box[4];
  int count;  // children in use, which come first
};

inline void convert_node(const BvhNode& node, const FixedFrame& frame, FixedNode* fixed) {
  auto convert = [&](int axis, int lane, std::int32_t flip, std::int32_t* middle, std::int32_t* half) {
    std::int32_t low = to_fixed(node.bounds[axis][lane], frame.exponent) - 1;
    std::int32_t high = to_fixed(node.bounds[3 + axis][lane], frame.exponent) + 1;
    *middle = ((low + high) >> 1) ^ flip, *half = ((high - low) >> 1) + 1 + kBoxSlack;
  };
  int lane = 0;
  for (; lane < 4 && node.child[lane] != kNoChild; ++lane) {
    FixedBox& box = fixed->box[lane];
    convert(frame.axes->z, lane, frame.flip, &box.z, &box.half_z);
    convert(frame.axes->x, lane, 0, &box.x, &box.half_x);
    convert(frame.axes->y, lane, 0, &box.y, &box.half_y);
  }
  fixed->count = lane;
}

// Whether the ray misses the box up to the depth `limit`; else *near receives the depth where it begins.
inline bool misses(const FixedRay& ray, const FixedBox& box, std::int32_t limit, std::int32_t* near) {
  std::int32_t z = box.z - ray.z;
  *near = z - box.half_z;
  if (*near > limit || z + box.half_z < 0) return true;
  std::int32_t x = box.x - ray.x - part(z, ray.shear_x), reach_x = box.half_x + part(box.half_z, ray.size_x);
  if (x > reach_x || -x > reach_x) return true;
  std::int32_t y = box.y - ray.y - part(z, ray.shear_y), reach_y = box.half_y + part(box.half_z, ray.size_y);
  if (y > reach_y || -y > reach_y) return true;
  std::int64_t across = product(x, ray.shear_y) - product(y, ray.shear_x);
  std::int64_t reach = product(box.half_x, ray.size_y) + product(box.half_y, ray.size_x);
  return across > reach || -across > reach;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
