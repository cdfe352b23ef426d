// A ray against the boxes of four children. Part of the kernels: see bvh_kernels.h.
//
// A box must never hide a hit of its triangles. The slab test [Kay & Kajiya 1986] is therefore made conservative, as in
// [Ize 2013, JCGT 2(2)], but in space: every plane is moved outwards by 16u (|o| + R), with u = 2^-24, o the origin's
// coordinate along its axis and R the farthest that the scene extends from the origin along any axis. That exceeds the
// sum of all errors: t = plane·inverse − offset rounds by 3u (|o| + R), including the inverse; cross_triangle() accepts
// hits of rays that miss the triangle by up to 6u R (shear, two products, differences); t itself rounds by u R.
#pragma once
#include <limits>

#include "accel/bvh.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Offsets in bytes of the rows of BvhNode::bounds where a ray of these signs (bit 0: d.x < 0 …) enters and leaves
// boxes. (Not every CPU scales an index when it loads four lanes.)
struct SlabRows {
  std::size_t near[3], far[3];
};
constexpr SlabRows slab_rows(int signs) {
  SlabRows rows = {};
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t low = sizeof(float[4]) * static_cast<std::size_t>(axis), high = low + sizeof(float[3][4]);
    bool backward = signs >> axis & 1;
    rows.near[axis] = backward ? high : low, rows.far[axis] = backward ? low : high;
  }
  return rows;
}
constexpr SlabRows kSlabRows[8] = {slab_rows(0), slab_rows(1), slab_rows(2), slab_rows(3),
                                   slab_rows(4), slab_rows(5), slab_rows(6), slab_rows(7)};

struct BoxRay {
  // t = plane · inverse − offset along each axis, for the planes where the ray enters and leaves.
  Float4 inverse[3], near_offset[3], far_offset[3];
  const SlabRows* rows;
  int exponent;  // boxes are entered at t · 2^exponent, which keeps directions from 1e-45 to 1e38 in range
};

// The largest component of the direction d must have a magnitude between 2^-20 and 2^20.
inline void make_box_ray(Float4 origin, Float4 d, Float4 low, Float4 high, BoxRay* r) {
  // Parallel to a slab, or nearly so: within t ≤ 2^20 R such a ray strays by 2^-40 R. No 0·∞ arises.
  Float4 inverse_size = Float4::splat(1) / max(abs(d), Float4::splat(0x1p-60f));
  Float4 inverse = copy_sign(inverse_size, d);
  Float4 reach = max(abs(low - origin), abs(high - origin));
  // 2^-100 covers denormal rounding. It is an absolute epsilon, but boxes decide no result.
  Float4 slack = (abs(origin) + Float4::splat(highest(reach))) * Float4::splat(0x1p-20f) + Float4::splat(0x1p-100f);
  Float4 offset = origin * inverse;
  slack = slack * inverse_size;
  Float4 near = offset + slack, far = offset - slack;
  r->inverse[0] = lane<0>(inverse), r->inverse[1] = lane<1>(inverse), r->inverse[2] = lane<2>(inverse);
  r->near_offset[0] = lane<0>(near), r->near_offset[1] = lane<1>(near), r->near_offset[2] = lane<2>(near);
  r->far_offset[0] = lane<0>(far), r->far_offset[1] = lane<1>(far), r->far_offset[2] = lane<2>(far);
  r->rows = &kSlabRows[signs(d) & 7];
}

// Distance up to which boxes must be entered to find all hits up to t.
inline float box_limit(int exponent, float t) {
  constexpr float kLeast = std::numeric_limits<float>::denorm_min();  // t may be rounded by half of this
  return __builtin_expect(exponent == 0, 1) ? t : std::ldexp(t + kLeast, exponent) + std::numeric_limits<float>::min();
}

// Mask of the children without a hit up to `limit`; `enter` receives the distance at which each is entered, never
// negative. A distance of −0 counts as negative: no hit lies there.
inline Mask4 miss_boxes(const BoxRay& ray, const BvhNode& node, Float4 limit, Float4* enter) {
  const char* bounds = reinterpret_cast<const char*>(node.bounds);
  const SlabRows& rows = *ray.rows;
  auto at = [&](const std::size_t* row, const Float4* offset, int axis) {
    const Float4 planes = Float4::load(reinterpret_cast<const float*>(bounds + row[axis]));
    return product_less(planes, ray.inverse[axis], offset[axis]);
  };
  Float4 enter_x = at(rows.near, ray.near_offset, 0);
  Float4 enter_y = at(rows.near, ray.near_offset, 1);
  Float4 enter_z = at(rows.near, ray.near_offset, 2);
  Float4 leave_x = at(rows.far, ray.far_offset, 0);
  Float4 leave_y = at(rows.far, ray.far_offset, 1);
  Float4 leave_z = at(rows.far, ray.far_offset, 2);
  *enter = later(later(enter_x, enter_y), later(enter_z, Float4::splat(0)));
  return is_later(*enter, sooner(sooner(leave_x, leave_y), sooner(leave_z, limit)));
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
