// Tests a ray against the four triangles of a leaf. Part of the kernels: see bvh_kernels.h.
//
// The edge functions of all four are computed in float as in cross_triangle(); unless one is zero, their signs decide.
// Triangles whose depth along the dominant axis excludes a hit (or, for a shadow ray, settles one) are done with: a hit
// lies between the nearest and the farthest vertex. Only the rest is located exactly, in double, as in
// intersect_triangle(), with the same bits of t, u and v.
#pragma once
#include <limits>

#include "accel/bvh.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// The axes, the direction's dominant one last, and their offsets in the rows of a vertex.
struct Axes {
  int x, y, z;
  std::size_t row_x, row_y, row_z;
};
constexpr Axes kAxesX = {1, 2, 0, 4, 8, 0}, kAxesY = {2, 0, 1, 8, 0, 4}, kAxesZ = {0, 1, 2, 0, 4, 8};
// By the set of largest components; the last of them dominates, as in make_sheared_ray().
constexpr Axes kAxesByGreatest[8] = {kAxesX, kAxesX, kAxesY, kAxesY, kAxesZ, kAxesZ, kAxesZ, kAxesZ};

// Ray data along those axes.
struct ExactRay {
  float origin[3], direction[3], shear[2];
  const Axes* axes;
};
struct LeafRay : ExactRay {
  Float4 origin_x, origin_y, origin_z, shear_x, shear_y;
  Float4 depth_low, depth_high;  // a triangle must overlap this to hold a hit that counts
};

// Hits at depths beyond those for t are farther than t. 2^-20 exceeds the rounding of depths, of t and of this bound.
inline void bound_depth(LeafRay* ray, float t) {
  constexpr float kSlack = 0x1p-20f;
  float far = (t + std::numeric_limits<float>::denorm_min()) * std::fabs(ray->direction[2]) * (1 + kSlack);
  Float4 end = Float4::splat(std::copysign(far, ray->direction[2])), zero = Float4::splat(0);
  ray->depth_low = min(end, zero), ray->depth_high = max(end, zero);
}

inline void make_exact_ray(const Ray& ray, const Axes* axes, ExactRay* r) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  r->axes = axes;
  r->origin[0] = o[axes->x], r->origin[1] = o[axes->y], r->origin[2] = o[axes->z];
  r->direction[0] = d[axes->x], r->direction[1] = d[axes->y], r->direction[2] = d[axes->z];
  r->shear[0] = r->direction[0] / r->direction[2], r->shear[1] = r->direction[1] / r->direction[2];
}

inline void make_leaf_ray(const Ray& ray, const Axes* axes, LeafRay* r) {
  make_exact_ray(ray, axes, r);
  r->origin_x = Float4::splat(r->origin[0]), r->origin_y = Float4::splat(r->origin[1]);
  r->origin_z = Float4::splat(r->origin[2]);
  r->shear_x = Float4::splat(r->shear[0]), r->shear_y = Float4::splat(r->shear[1]);
  bound_depth(r, ray.t_max);
}

// A triangle that lies entirely between these depths certainly has t in (0, t_max).
struct SureDepths {
  Float4 low, high;
};
inline SureDepths sure_depths(float t_max, float direction_z) {
  // Within these bounds, t neither overflows nor rounds to 0 or to t_max. Denormals are excluded because they slow the
  // CPU down.
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = 0x1p-80f;
  float size = std::fabs(direction_z), far = (t_max < kMax ? t_max : kMax) * size * (1 - 0x1p-20f);
  float near = (size + 1) * kTiny;
  if (!(far >= kTiny)) far = 0;
  return {Float4::splat(direction_z < 0 ? -far : near), Float4::splat(direction_z < 0 ? -near : far)};
}

// Masks of lanes.
struct LeafLanes {
  unsigned pass;      // edge functions and depth do not exclude a hit
  unsigned doubtful;  // passes, but an edge function is zero
  unsigned sure;      // passes, and is certainly hit in (0, t_max)
};

// One vertex of several triangles, relative to the origin.
template <class T>
struct Corner {
  T x, y, z;
};
inline Corner<Float4> shear_corner(const LeafRay& ray, const float* vertex) {
  Float4 z = Float4::load(vertex + ray.axes->row_z) - ray.origin_z;
  return {(Float4::load(vertex + ray.axes->row_x) - ray.origin_x) - ray.shear_x * z,
          (Float4::load(vertex + ray.axes->row_y) - ray.origin_y) - ray.shear_y * z, z};
}

template <bool kAny>
inline LeafLanes test_leaf(const LeafRay& ray, const SureDepths* sure, const TriangleBlock& block) {
  Corner<Float4> p = shear_corner(ray, block.vertex[0][0]), q = shear_corner(ray, block.vertex[1][0]),
                 r = shear_corner(ray, block.vertex[2][0]);
  Float4 a = r.x * q.y - r.y * q.x;
  Float4 b = p.x * r.y - p.y * r.x;
  Float4 c = q.x * p.y - q.y * p.x;
  Float4 low = min(min(a, b), c), high = max(max(a, b), c), zero = Float4::splat(0);
  Float4 nearest = min(min(p.z, q.z), r.z), farthest = max(max(p.z, q.z), r.z);
  Mask4 within = (nearest <= ray.depth_high) & (ray.depth_low <= farthest);
  LeafLanes lanes;
  lanes.pass = bits(((zero <= low) | (high <= zero)) & within);
  Mask4 decided = (zero < low) | (high < zero);
  lanes.doubtful = ~bits(decided);
  lanes.sure = 0;
  if (kAny) lanes.sure = bits(decided & (sure->low <= nearest) & (farthest <= sure->high));
  return lanes;
}

// exact_weights() and place_crossing() for a triangle of the leaf. Returns false if the weights differ in sign.
// kSigned: they are known not to.
template <bool kSigned = false>
inline bool place_in_leaf(const ExactRay& ray, const TriangleBlock& block, int lane, Crossing* crossing) {
  double ox = ray.origin[0], oy = ray.origin[1], oz = ray.origin[2];
  double dx = ray.direction[0], dy = ray.direction[1], dz = ray.direction[2];
  const float* vertex = block.vertex[0][0] + lane;
  auto corner = [&](int i) {
    const float* v = vertex + 12 * i;
    double z = v[ray.axes->row_z] - oz;
    return Corner<double>{(v[ray.axes->row_x] - ox) * dz - z * dx, (v[ray.axes->row_y] - oy) * dz - z * dy, z};
  };
  Corner<double> p = corner(0), q = corner(1), r = corner(2);
  EdgeValues<double> w = edge_values<double>(p.x, p.y, q.x, q.y, r.x, r.y);
  if constexpr (!kSigned) {
    // A single branch: which side of a triangle a ray meets is unpredictable.
    bool above = (w.a >= 0) & (w.b >= 0) & (w.c >= 0), below = (w.a <= 0) & (w.b <= 0) & (w.c <= 0);
    if (above == below) return false;
  }
  double sum = w.a + w.b + w.c;
  *crossing = {w.b, w.c, sum, static_cast<float>((w.a * p.z + w.b * q.z + w.c * r.z) / (sum * dz))};
  // cross_alone() decides whether the ray begins on the plane.
  return !is_close_hit(crossing->t, ray.direction[2], p.z, q.z, r.z);
}

// Tests one triangle by itself, where an edge function is zero or rounding makes decision and weights disagree.
__attribute__((noinline)) inline bool cross_alone(const ExactRay& ray, const TriangleBlock& block, int lane,
                                                  Crossing* crossing) {
  const Axes& k = *ray.axes;
  ShearedRay sheared = {{}, {}, k.x, k.y, k.z, ray.shear[0], ray.shear[1]};
  sheared.origin[k.x] = ray.origin[0], sheared.origin[k.y] = ray.origin[1], sheared.origin[k.z] = ray.origin[2];
  sheared.direction[k.x] = ray.direction[0], sheared.direction[k.y] = ray.direction[1];
  sheared.direction[k.z] = ray.direction[2];
  return cross_triangle(sheared, block_vertex(block, 0, lane), block_vertex(block, 1, lane),
                        block_vertex(block, 2, lane), crossing);
}

// Calls visit(lane, crossing) for each lane that the ray crosses, until it returns true.
template <class Visit>
inline bool for_each_crossing(const LeafRay& ray, const TriangleBlock& block, unsigned pass, unsigned doubtful,
                              Visit visit) {
  for (unsigned left = pass; left; left &= left - 1) {
    int lane = __builtin_ctz(left);
    Crossing crossing;
    if ((doubtful >> lane & 1) || !place_in_leaf(ray, block, lane, &crossing))
      if (!cross_alone(ray, block, lane, &crossing)) continue;
    if (visit(lane, crossing)) return true;
  }
  return false;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
