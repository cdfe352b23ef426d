// A ray against the boxes of four children. Part of the kernels: see bvh_kernels.h.
//
// A box must never hide a hit of its triangles. The slab test [Kay & Kajiya 1986] is therefore slackened, as [Ize 2013,
// JCGT 2(2)] asks, but by more than his 2 ulp of each distance: intersect_triangle() takes a ray for a hit that passes
// a triangle by up to 4u of the distance along the dominant axis at which the vertices lie (u = 2^-24: shear, two
// products and a difference), which may be larger than the distance of the hit. With Z the farthest such distance in
// the scene the errors of the triangle test (6u Z), of the slabs (3u) and of t itself (u) stay below 16u Z for each
// side of an interval.
#pragma once
#include <limits>

#include "accel/bvh.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

struct BoxRay {
  Float4 near_origin[3], far_origin[3], inverse[3];
  Float4 slack;                               // 32u Z, in units of t
  std::size_t near_offset[3], far_offset[3];  // in BvhNode::bounds, of the rows in which the ray enters and leaves
  float slack_t;
  int exponent;  // boxes are entered at t · 2^exponent: keeps directions from 1e-45 to 1e38 in range
};

// One axis of the slabs; `backward` where the ray enters by the high bound.
inline void set_slab(BoxRay* r, int axis, float near, float far, float inverse, bool backward) {
  std::size_t low = 4 * static_cast<std::size_t>(axis), high = low + 12;
  std::size_t swap = (low ^ high) & -static_cast<std::size_t>(backward);
  r->near_offset[axis] = low ^ swap, r->far_offset[axis] = high ^ swap;
  r->near_origin[axis] = Float4::splat(near), r->far_origin[axis] = Float4::splat(far);
  r->inverse[axis] = Float4::splat(inverse);
}

// For a direction d whose component along kz, the dominant one, is neither tiny nor huge.
inline void set_slabs(const Vec3& origin, const Vec3& d, int kz, const Box& bounds, BoxRay* r) {
  float size = std::fabs(d[kz]), o = origin[kz], inverse_size = 1 / size;
  float reach_low = std::fabs(bounds.low[kz] - o), reach_high = std::fabs(bounds.high[kz] - o);
  float reach = reach_low > reach_high ? reach_low : reach_high;  // Z
  // The powers of two below 2^-90 cover denormal rounding; they are relative to nothing, but boxes decide no result.
  r->slack_t = (reach * 0x1p-19f + 0x1p-100f) * inverse_size;
  r->slack = Float4::splat(r->slack_t);
  set_slab(r, 0, origin.x, origin.x, 1 / d.x, d.x < 0);
  set_slab(r, 1, origin.y, origin.y, 1 / d.y, d.y < 0);
  set_slab(r, 2, origin.z, origin.z, 1 / d.z, d.z < 0);
  Vec3 along = abs(d);
  float parallel = size * 0x1p-40f;
  if (along.x >= parallel && along.y >= parallel && along.z >= parallel) return;
  // Parallel to a slab, or as good as: inside a slightly wider slab everywhere or nowhere. No 0·∞ arises.
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] >= parallel) continue;
    float wider = (std::fabs(origin[axis]) + reach) * 0x1p-20f + 0x1p-90f;
    set_slab(r, axis, origin[axis] + wider, origin[axis] - wider, 0x1p44f * inverse_size, false);
  }
}

inline void make_box_ray(const Ray& ray, int kz, const Box& bounds, BoxRay* r) {
  r->exponent = 0;
  float size = std::fabs(ray.direction[kz]);
  if (size >= 0x1p-40f && size <= 0x1p40f) return set_slabs(ray.origin, ray.direction, kz, bounds, r);
  Vec3 d;
  std::frexp(size, &r->exponent);
  for (int axis = 0; axis < 3; ++axis) d[axis] = std::ldexp(ray.direction[axis], -r->exponent);
  set_slabs(ray.origin, d, kz, bounds, r);
}

// The distance up to which boxes have to be entered for hits up to t.
inline float box_limit(const BoxRay& ray, float t) {
  return (ray.exponent == 0 ? t : std::ldexp(t, ray.exponent) + std::numeric_limits<float>::min()) + ray.slack_t;
}

// Mask of the children that may hold a hit up to `limit`; `enter`, none below 0, gets where each is entered.
inline unsigned enter_boxes(const BoxRay& ray, const BvhNode& node, Float4 limit, float* enter) {
  const float* bounds = node.bounds[0];
  Float4 enter_x = (Float4::load(bounds + ray.near_offset[0]) - ray.near_origin[0]) * ray.inverse[0];
  Float4 enter_y = (Float4::load(bounds + ray.near_offset[1]) - ray.near_origin[1]) * ray.inverse[1];
  Float4 enter_z = (Float4::load(bounds + ray.near_offset[2]) - ray.near_origin[2]) * ray.inverse[2];
  Float4 leave_x = (Float4::load(bounds + ray.far_offset[0]) - ray.far_origin[0]) * ray.inverse[0];
  Float4 leave_y = (Float4::load(bounds + ray.far_offset[1]) - ray.far_origin[1]) * ray.inverse[1];
  Float4 leave_z = (Float4::load(bounds + ray.far_offset[2]) - ray.far_origin[2]) * ray.inverse[2];
  Float4 entered = max(max(enter_x, enter_y), max(enter_z, Float4::splat(0)));
  Float4 left = min(min(min(leave_x, leave_y), leave_z) + ray.slack, limit);
  store(enter, entered);
  return bits(entered <= left);
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
