// A ray in fixed point against a triangle. Part of the kernels: see bvh_fixed.h.
//
// The edge functions of cross_triangle() are computed exactly from sheared vertices that differ from its own by less
// than a bound δ in each coordinate: 5 units here (fixed_ray.h) and, there, 2u|x| + 4u|z| (two differences, shear and
// product; u = 2^-24). With A the largest |x| or |y| of a vertex, an edge function errs by less than 4δ(A + δ). Beyond
// that its sign is known.
#pragma once
#include "accel/fixed_ray.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Vertices of the triangles: z of all three, then x, then y.
struct FixedLeaf {
  std::int32_t vertex[4][9];
};

inline void convert_leaf(const TriangleBlock& block, int count, const FixedFrame& frame, FixedLeaf* fixed) {
  for (int lane = 0; lane < count; ++lane) {
    std::int32_t* v = fixed->vertex[lane];
    for (int i = 0; i < 3; ++i) {
      v[i] = flipped(frame, to_fixed(block.vertex[i][frame.axes->z][lane], frame.exponent));
      v[3 + i] = to_fixed(block.vertex[i][frame.axes->x][lane], frame.exponent);
      v[6 + i] = to_fixed(block.vertex[i][frame.axes->y][lane], frame.exponent);
    }
  }
}

// doubtful: too close to decide here. crossed: the line is, with t > 0 unless behind. Depths of the vertices lie
// between `nearest` and `farthest`, with an error below 2.
enum class FixedVerdict { missed, doubtful, crossed };

inline std::int32_t least(std::int32_t a, std::int32_t b) { return a < b ? a : b; }
inline std::int32_t most(std::int32_t a, std::int32_t b) { return a > b ? a : b; }
inline std::int64_t least(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
inline std::int64_t most(std::int64_t a, std::int64_t b) { return a > b ? a : b; }

// One coordinate of the vertices as seen from the ray.
struct FixedRow {
  std::int32_t at[3], low, high;
};
inline FixedRow sheared_row(const std::int32_t* v, std::int32_t origin, std::int32_t shear, const FixedRow& z) {
  FixedRow r;
  for (int i = 0; i < 3; ++i) r.at[i] = v[i] - origin - part(z.at[i], shear);
  r.low = least(least(r.at[0], r.at[1]), r.at[2]), r.high = most(most(r.at[0], r.at[1]), r.at[2]);
  return r;
}
inline FixedRow depth_row(const FixedRay& ray, const std::int32_t* v) {
  FixedRow r;
  for (int i = 0; i < 3; ++i) r.at[i] = v[i] - ray.z;
  r.low = least(least(r.at[0], r.at[1]), r.at[2]), r.high = most(most(r.at[0], r.at[1]), r.at[2]);
  return r;
}

// Where the ray's line crosses the triangle `v` with vertices at depths z. *positive: sign of the edge functions if
// crossed.
inline FixedVerdict cross_fixed(const FixedRay& ray, const std::int32_t* v, const FixedRow& z, bool* positive) {
  // Where |x| exceeds this, 2u|x| is less than the rest of the excess.
  std::int32_t slack = 8 + (most(z.high, -z.low) >> 19);
  FixedRow x = sheared_row(v + 3, ray.x, ray.shear_x, z);
  if (x.low > slack || x.high < -slack) return FixedVerdict::missed;
  FixedRow y = sheared_row(v + 6, ray.y, ray.shear_y, z);
  if (y.low > slack || y.high < -slack) return FixedVerdict::missed;
  auto edge = [&](int i, int j) { return product(x.at[j], y.at[i]) - product(y.at[j], x.at[i]); };
  std::int64_t a = edge(1, 2), b = edge(2, 0), c = edge(0, 1);
  std::int64_t low = least(least(a, b), c), high = most(most(a, b), c);
  std::int32_t size = most(most(x.high, -x.low), most(y.high, -y.low)), error = slack + (size >> 20);
  std::int64_t edge_error = 4 * product(error, size + error);
  *positive = low > edge_error;
  if (*positive || high < -edge_error) return FixedVerdict::crossed;
  return low < -edge_error && edge_error < high ? FixedVerdict::missed : FixedVerdict::doubtful;
}

// Whether the triangle, which the ray's line crosses, certainly lies behind the origin: t < 0. Let n be its normal and
// d the direction: n·d is minus the sum of the edge functions, and t = n·a / n·d for a vertex a. By the weights of the
// crossing, vertices and origin that err by less than 2 in each coordinate move the plane there by less than 2|n|₁. The
// components of n are cut to 31 bits, which costs 3·2^29; the rounding of cross_triangle()'s weights, below 2^-48 of
// the cube of the triangle's size, is less than that where n is large enough.
inline bool surely_behind(const FixedRay& ray, const std::int32_t* v, const FixedRow& z, bool positive) {
  std::int32_t p[3] = {v[3] - ray.x, v[6] - ray.y, z.at[0]};
  std::int32_t e[3] = {v[4] - v[3], v[7] - v[6], v[1] - v[0]}, f[3] = {v[5] - v[3], v[8] - v[6], v[2] - v[0]};
  std::int64_t n[3] = {product(e[1], f[2]) - product(e[2], f[1]), product(e[2], f[0]) - product(e[0], f[2]),
                       product(e[0], f[1]) - product(e[1], f[0])};
  std::uint64_t bits = 0;
  for (std::int64_t k : n) bits |= static_cast<std::uint64_t>(k < 0 ? ~k : k);
  constexpr std::uint32_t kLeast = 1u << 10;
  std::uint32_t upper = static_cast<std::uint32_t>(bits >> 32);
  if (upper < kLeast) return false;
  int cut = 34 - __builtin_clz(upper);
  std::int64_t height = 0, error = std::int64_t(1) << 32;
  for (int k = 0; k < 3; ++k) {
    std::int32_t component = static_cast<std::int32_t>(n[k] >> cut);
    height += product(component, p[k]);
    error += 2 * static_cast<std::int64_t>(component < 0 ? -component : component);
  }
  return positive ? height > error : height < -error;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
