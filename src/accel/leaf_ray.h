// A ray against the four triangles of a leaf. Part of the kernels: see bvh_kernels.h.
//
// The edge functions of all four are found in float, as cross_triangle() has them; where none is zero their signs
// decide. What a triangle's depth along the dominant axis excludes, or for a shadow ray settles, ends there: a hit lies
// between the nearest and the farthest vertex. Only what is left is placed exactly, in double, two triangles at a time:
// exact_weights() lane by lane, so t, u and v are the bits of intersect_triangle().
#pragma once
#include <limits>

#include "accel/bvh.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

struct LeafRay {
  Float4 origin_x, origin_y, origin_z, shear_x, shear_y;  // x, y, z: the axes kx, ky, kz
  Float4 depth_low, depth_high;                           // what a triangle must overlap to hold a hit that counts …
  Float4 sure_low, sure_high;                             // … and where all of it lies in (0, t_max)
  Double2 exact_origin_x, exact_origin_y, exact_origin_z, direction_x, direction_y, direction_z;
  std::size_t row_x, row_y, row_z;  // offsets of the axes in the rows of a vertex
  ShearedRay sheared;
  float direction_depth;
};

// Hits at depths beyond those for t are farther than t. 2^-20 is more than the rounding of depths, of t and of this.
inline void bound_depth(LeafRay* ray, float t) {
  constexpr float kSlack = 0x1p-20f;
  float far = (t + std::numeric_limits<float>::denorm_min()) * std::fabs(ray->direction_depth) * (1 + kSlack);
  if (ray->direction_depth < 0)
    ray->depth_low = Float4::splat(-far);
  else
    ray->depth_high = Float4::splat(far);
}

// r->sheared is there already.
inline void make_leaf_ray(const Ray& ray, LeafRay* r) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  const ShearedRay& sheared = r->sheared;
  int kx = sheared.kx, ky = sheared.ky, kz = sheared.kz;
  float t_max = ray.t_max;
  r->row_x = 4 * static_cast<std::size_t>(kx), r->row_y = 4 * static_cast<std::size_t>(ky);
  r->row_z = 4 * static_cast<std::size_t>(kz);
  r->origin_x = Float4::splat(o[kx]), r->origin_y = Float4::splat(o[ky]), r->origin_z = Float4::splat(o[kz]);
  r->shear_x = Float4::splat(sheared.shear_x), r->shear_y = Float4::splat(sheared.shear_y);
  r->exact_origin_x = Double2::splat(o[kx]), r->exact_origin_y = Double2::splat(o[ky]);
  r->exact_origin_z = Double2::splat(o[kz]);
  r->direction_x = Double2::splat(d[kx]), r->direction_y = Double2::splat(d[ky]),
  r->direction_z = Double2::splat(d[kz]);
  r->direction_depth = d[kz];
  r->depth_low = r->depth_high = Float4::splat(0);
  bound_depth(r, t_max);
  // Within these t neither overflows nor rounds to 0 or to t_max. No denormals here: they take the CPU long.
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = 0x1p-80f;
  float size = std::fabs(d[kz]), far = (t_max < kMax ? t_max : kMax) * size * (1 - 0x1p-20f);
  float near = (size + 1) * kTiny;
  if (!(far >= kTiny)) far = 0;
  r->sure_low = Float4::splat(d[kz] < 0 ? -far : near), r->sure_high = Float4::splat(d[kz] < 0 ? -near : far);
}

// Masks of lanes.
struct LeafLanes {
  unsigned pass;      // the edge functions and the depth do not exclude a hit
  unsigned doubtful;  // of them, those with a zero edge function
  unsigned sure;      // certainly hit in (0, t_max)
};

// A vertex of several triangles, relative to the origin.
template <class T>
struct Corner {
  T x, y, z;
};
inline Corner<Float4> shear_corner(const LeafRay& ray, const float* vertex) {
  Float4 z = Float4::load(vertex + ray.row_z) - ray.origin_z;
  return {(Float4::load(vertex + ray.row_x) - ray.origin_x) - ray.shear_x * z,
          (Float4::load(vertex + ray.row_y) - ray.origin_y) - ray.shear_y * z, z};
}

template <bool kAny>
LeafLanes test_leaf(const LeafRay& ray, const TriangleBlock& block) {
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
  lanes.doubtful = lanes.sure = 0;
  if (!lanes.pass) return lanes;
  Mask4 decided = (zero < low) | (high < zero);
  lanes.doubtful = lanes.pass & ~bits(decided);
  if (kAny) lanes.sure = bits(decided & (ray.sure_low <= nearest) & (farthest <= ray.sure_high));
  return lanes;
}

// Where the ray crosses the triangles of half a leaf.
struct alignas(16) HalfCrossing {
  double b[2], c[2], sum[2], t[2];
  unsigned proper;  // lanes whose weights agree in sign and are not all zero
};

inline Corner<Double2> exact_corner(const LeafRay& ray, const float* vertex) {
  Double2 z = Double2::widen(vertex + ray.row_z) - ray.exact_origin_z;
  return {(Double2::widen(vertex + ray.row_x) - ray.exact_origin_x) * ray.direction_z - z * ray.direction_x,
          (Double2::widen(vertex + ray.row_y) - ray.exact_origin_y) * ray.direction_z - z * ray.direction_y, z};
}

inline HalfCrossing cross_half(const LeafRay& ray, const TriangleBlock& block, int first) {
  Corner<Double2> p = exact_corner(ray, block.vertex[0][0] + first), q = exact_corner(ray, block.vertex[1][0] + first),
                  r = exact_corner(ray, block.vertex[2][0] + first);
  Double2 a = r.x * q.y - r.y * q.x, b = p.x * r.y - p.y * r.x, c = q.x * p.y - q.y * p.x;
  Double2 zero = Double2::splat(0), low = min(min(a, b), c), high = max(max(a, b), c);
  DoubleMask2 proper = ((zero <= low) & (zero < high)) | ((high <= zero) & (low < zero));
  Double2 sum = a + b + c, depth = a * p.z + b * q.z + c * r.z;
  HalfCrossing half;
  store(half.b, b), store(half.c, c), store(half.sum, sum);
  store(half.t, depth / (select(proper, sum, Double2::splat(1)) * ray.direction_z));
  half.proper = bits(proper);
  return half;
}

// One triangle by itself: where an edge function is zero or rounding makes decision and weights disagree.
inline bool cross_alone(const LeafRay& ray, const TriangleBlock& block, int lane, Crossing* crossing) {
  return cross_triangle(ray.sheared, block_vertex(block, 0, lane), block_vertex(block, 1, lane),
                        block_vertex(block, 2, lane), crossing);
}

// Calls visit(lane, crossing) for the lanes of the leaf that the ray crosses, until it returns true.
template <class Visit>
bool for_each_crossing(const LeafRay& ray, const TriangleBlock& block, const LeafLanes& lanes, Visit visit) {
  for (unsigned left = lanes.pass; left;) {
    int lane = __builtin_ctz(left), first = lane & 2;
    HalfCrossing half = cross_half(ray, block, first);
    unsigned placed = half.proper << first & ~lanes.doubtful;
    for (unsigned m = left & (3u << first); m; m &= m - 1) {
      lane = __builtin_ctz(m);
      int i = lane & 1;
      Crossing crossing = {half.b[i], half.c[i], half.sum[i], static_cast<float>(half.t[i])};
      if (!(placed >> lane & 1) && !cross_alone(ray, block, lane, &crossing)) continue;
      if (visit(lane, crossing)) return true;
    }
    left &= ~(3u << first);
  }
  return false;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
