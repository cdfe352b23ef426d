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

inline std::int32_t least(std::int32_t a, std::int32_t b) { return a < b ? a : b; }
inline std::int32_t most(std::int32_t a, std::int32_t b) { return a > b ? a : b; }
inline std::int64_t least(std::int64_t a, std::int64_t b) { return a < b ? a : b; }
inline std::int64_t most(std::int64_t a, std::int64_t b) { return a > b ? a : b; }

// One coordinate of the vertices.
struct FixedRow {
  std::int32_t at[3], low, high;
};
inline void set_range(FixedRow* r) {
  r->low = least(least(r->at[0], r->at[1]), r->at[2]), r->high = most(most(r->at[0], r->at[1]), r->at[2]);
}

struct FixedTriangle {
  FixedRow z;
  std::int32_t x[3], y[3];
};
inline FixedTriangle fixed_triangle(const TriangleBlock& block, int lane, const FixedFrame& frame) {
  FixedTriangle v;
  for (int i = 0; i < 3; ++i) {
    v.z.at[i] = flipped(frame, to_fixed(block.vertex[i][frame.axes->z][lane], frame.exponent));
    v.x[i] = to_fixed(block.vertex[i][frame.axes->x][lane], frame.exponent);
    v.y[i] = to_fixed(block.vertex[i][frame.axes->y][lane], frame.exponent);
  }
  set_range(&v.z);
  return v;
}

// Shears a coordinate of the vertices into the ray's frame.
inline FixedRow sheared_row(const std::int32_t* v, std::int32_t origin, std::int32_t shear, const FixedRow& z) {
  FixedRow r;
  for (int i = 0; i < 3; ++i) r.at[i] = v[i] - origin - part(z.at[i], shear);
  set_range(&r);
  return r;
}
inline FixedRow depth_row(const FixedRay& ray, const FixedTriangle& v) {
  return {{v.z.at[0] - ray.z, v.z.at[1] - ray.z, v.z.at[2] - ray.z}, v.z.low - ray.z, v.z.high - ray.z};
}

// doubtful: too close to decide here.
enum class FixedVerdict { missed, doubtful, crossed };

// Classifies the ray's line against the triangle `v` with vertices at depths z. *positive: sign of the edge functions
// if crossed.
inline FixedVerdict cross_fixed(const FixedRay& ray, const FixedTriangle& v, const FixedRow& z, bool* positive) {
  // Where |x| exceeds this, 2u|x| is less than the rest of the excess.
  std::int32_t slack = 8 + (most(z.high, -z.low) >> 19);
  FixedRow x = sheared_row(v.x, ray.x, ray.shear_x, z);
  if (x.low > slack || x.high < -slack) return FixedVerdict::missed;
  FixedRow y = sheared_row(v.y, ray.y, ray.shear_y, z);
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

// The plane of a triangle that the ray's line crosses.
//
// Let n be its normal and d the direction: n·d is minus the sum of the edge functions, and the line meets the plane
// beyond its point q where n·(a − q), the height for a vertex a, has the sign of n·d. By the weights of the crossing,
// points that err by less than δ in each coordinate, q and the vertices together, move the plane there by less than
// δ |n|₁; δ is 2 for the origin, 8 for other points of the line. In cross_triangle() the sum of weights times depths
// rounds by less than 2^-44 S³, S the triangle's extent from the origin, which fixed_plane() keeps below |n|₁. Last,
// the components of n are cut to 31 bits, which costs 3·2^30.
struct FixedPlane {
  std::int32_t normal[3], vertex[3];  // by x, y, z; the vertex from the origin
  std::int64_t size, cut_error;       // |n|₁; error of a height
  bool against;                       // the ray runs against the normal
};

inline int bit_length(std::uint32_t a) { return a ? 32 - __builtin_clz(a) : 0; }

// Returns false if rounding could decide on which side a point lies.
inline bool fixed_plane(const FixedRay& ray, const FixedTriangle& v, const FixedRow& z, bool positive,
                        FixedPlane* plane) {
  std::int32_t p[3][3];  // the vertices from the origin, by axis
  std::uint32_t extent = 0;
  for (int i = 0; i < 3; ++i) {
    p[0][i] = v.x[i] - ray.x, p[1][i] = v.y[i] - ray.y, p[2][i] = z.at[i];
    extent |= magnitude(p[0][i]) | magnitude(p[1][i]) | magnitude(p[2][i]);
  }
  std::int64_t n[3];
  std::uint64_t bits = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t *r = p[k == 2 ? 0 : k + 1], *s = p[k == 0 ? 2 : k - 1];
    n[k] = product(r[1] - r[0], s[2] - s[0]) - product(s[1] - s[0], r[2] - r[0]);
    bits |= static_cast<std::uint64_t>(n[k] < 0 ? ~n[k] : n[k]);
  }
  std::uint32_t upper = static_cast<std::uint32_t>(bits >> 32);
  int length = upper ? 32 + bit_length(upper) : bit_length(static_cast<std::uint32_t>(bits));
  if (length == 0 || length < 3 * bit_length(extent) - 43) return false;
  int cut = length > 31 ? length - 31 : 0;
  plane->size = 3, plane->cut_error = cut > 0 ? std::int64_t(1) << 32 : 0;
  for (int k = 0; k < 3; ++k) {
    plane->normal[k] = static_cast<std::int32_t>(n[k] >> cut), plane->vertex[k] = p[k][0];
    plane->size += magnitude(plane->normal[k]);
  }
  plane->against = positive;
  return true;
}

// Where the ray's line meets the plane, relative to its point at a depth.
enum class FixedSide { unknown, before, beyond };
inline FixedSide meets_plane(const FixedPlane& plane, const FixedRay& ray, std::int32_t depth) {
  std::int32_t x = plane.vertex[0], y = plane.vertex[1], z = plane.vertex[2] - depth;
  if (depth != 0) x -= part(depth, ray.shear_x), y -= part(depth, ray.shear_y);
  std::int64_t height = product(plane.normal[0], x) + product(plane.normal[1], y) + product(plane.normal[2], z);
  std::int64_t error = plane.cut_error + (depth != 0 ? 9 : 3) * plane.size;
  if (plane.against) height = -height;
  return height > error ? FixedSide::beyond : height < -error ? FixedSide::before : FixedSide::unknown;
}

// Returns whether the triangle certainly has no t in (0, t_max); `limit` is the depth for t_max.
inline bool surely_outside(const FixedPlane& plane, const FixedRay& ray, const FixedRow& z, std::int32_t limit) {
  return (z.low < 4 && meets_plane(plane, ray, 0) == FixedSide::before) ||
         (z.high > limit && meets_plane(plane, ray, limit) == FixedSide::beyond);
}
// Returns whether its t certainly lies between the sure depths.
inline bool surely_inside(const FixedPlane& plane, const FixedRay& ray, const FixedRow& z, const FixedDepths& sure) {
  return (sure.low <= z.low || meets_plane(plane, ray, sure.low) == FixedSide::beyond) &&
         (z.high <= sure.high || meets_plane(plane, ray, sure.high) == FixedSide::before);
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
