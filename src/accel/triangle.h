// The triangle test of all accelerators: watertight, two-sided, without epsilons, the same bits on every CPU.
//
// The hit decision follows [Woop, Benthin, Wald 2013, JCGT 2(1)] secs. 3.1–3.3: vertices are translated to the origin
// of the ray and sheared so that it runs along one axis, in float, each vertex independently; then the signs of the
// three edge functions decide. Rounding is monotonic, so a float edge function other than zero has the exact sign;
// where it is zero, double holds the products exactly. Triangles that share an edge see opposite signs, so no ray slips
// between them. An edge belongs to both its triangles.
//
// The location of the hit is computed separately (our deviation), in double from the original vertices: t, u and v are
// then within an ulp even for tiny or distant triangles. If rounding makes those weights disagree with the decision,
// within a few ulp of an edge, the weights of the sheared vertices are used, which agree by construction.
#pragma once
#include "accel/ray.h"
#include "base/array.h"
#include "base/isa.h"
#include "base/limits.h"
#include "base/simd.h"
#include "scene/scene.h"

namespace pocketray {

// Four triangles side by side: vertex, axis, lane.
struct alignas(16) TriangleBlock {
  float vertex[3][3][4];
  std::uint32_t triangle[4];
};
static_assert(sizeof(TriangleBlock) == 160, "nine rows of floats and one of ids");

// Returns whether a triangle can be hit at all: indices in range, vertices within kCoordinateMax, corners not
// collinear. All accelerators skip the others.
inline bool has_valid_vertices(Array<const Vec3> positions, const Triangle& triangle) {
  for (std::uint32_t vertex : triangle.vertices()) {
    if (vertex >= positions.count) return false;
    Vec3 p = abs(positions[vertex]);
    if (!(p.x <= kCoordinateMax && p.y <= kCoordinateMax && p.z <= kCoordinateMax)) return false;
  }
  return true;
}
inline bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  return is_zero(cross(to_double(b) - to_double(a), to_double(c) - to_double(a)));
}
inline bool is_hittable(Array<const Vec3> positions, const Triangle& triangle) {
  return has_valid_vertices(positions, triangle) &&
         !is_degenerate(positions[triangle.vertex(0)], positions[triangle.vertex(1)], positions[triangle.vertex(2)]);
}

inline namespace POCKETRAY_ISA {

// A ray prepared for the test. kz is the dominant axis of the direction.
struct ShearedRay {
  Vec3 origin, direction;
  int kx, ky, kz;
  float shear_x, shear_y;  // eq. (2) of the paper, without S_z: t is computed separately
};

// Rays with origins beyond this hit nothing; within it, no product of the test overflows.
constexpr float kOriginMax = 4 * kCoordinateMax;

inline bool has_valid_origin(const Vec3& origin) {
  Vec3 o = abs(origin);
  return o.x <= kOriginMax && o.y <= kOriginMax && o.z <= kOriginMax;
}

// Returns false if the ray cannot hit anything: origin not finite or beyond kOriginMax, direction zero or not finite.
inline bool make_sheared_ray(const Ray& ray, ShearedRay* result) {
  Vec3 d = abs(ray.direction);
  if (!has_valid_origin(ray.origin)) return false;
  if (!is_finite(ray.direction) || is_zero(ray.direction)) return false;
  // Branch-free: for incoherent rays branches are unpredictable.
  int wider = !(d.x > d.y), kz = (d.x > d.y ? d.x : d.y) > d.z ? wider : 2;
  constexpr int kNext[] = {1, 2, 0};
  int kx = kNext[kz], ky = kNext[kx];
  float dz = ray.direction[kz];
  *result = {ray.origin, ray.direction, kx, ky, kz, ray.direction[kx] / dz, ray.direction[ky] / dz};
  return true;
}

// Edge functions of a triangle; also the weights of its vertices before division by their sum.
template <class T>
struct EdgeValues {
  T a, b, c;
};
template <class T>
inline EdgeValues<T> edge_values(T ax, T ay, T bx, T by, T cx, T cy) {
  return {cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax};
}
template <class T>
inline bool signs_differ(const EdgeValues<T>& e) {
  return (e.a < 0 || e.b < 0 || e.c < 0) && (e.a > 0 || e.b > 0 || e.c > 0);
}
template <class T>
inline bool all_zero(const EdgeValues<T>& e) {
  return e.a == 0 && e.b == 0 && e.c == 0;
}

// Weights of the vertices at the crossing, in double from the original vertices. Both coordinates carry a factor
// direction[kz]; it appears squared in the weights and so changes neither their signs nor their ratios.
inline EdgeValues<double> exact_weights(const ShearedRay& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  double ox = ray.origin[ray.kx], oy = ray.origin[ray.ky], oz = ray.origin[ray.kz];
  double dx = ray.direction[ray.kx], dy = ray.direction[ray.ky], dz = ray.direction[ray.kz];
  double az = a[ray.kz] - oz, bz = b[ray.kz] - oz, cz = c[ray.kz] - oz;
  return edge_values<double>((a[ray.kx] - ox) * dz - az * dx, (a[ray.ky] - oy) * dz - az * dy,  //
                             (b[ray.kx] - ox) * dz - bz * dx, (b[ray.ky] - oy) * dz - bz * dy,  //
                             (c[ray.kx] - ox) * dz - cz * dx, (c[ray.ky] - oy) * dz - cz * dy);
}

// Where a ray crosses a triangle: t, and the weights of b and c relative to the sum of all three.
struct Crossing {
  double b, c, sum;
  float t;
};

// A ray that begins on a triangle's plane does not hit it: t would be a rounded 0. Close hits, compared with the
// largest depth of a vertex, are tested for this. Rounding of t grows towards grazing rays, but stays below this limit.
constexpr float kCloseHit = 0x1p-16f;
static_assert(kCloseHit > 0x1p-20f, "beyond the rounding of t and of depths");
inline bool is_close_hit(float t, float direction_z, double az, double bz, double cz) {
  if (!(t > 0)) return false;
  const float a = static_cast<float>(std::fabs(az)), b = static_cast<float>(std::fabs(bz)),
              c = static_cast<float>(std::fabs(cz)), farther = a > b ? a : b;
  return std::fabs(t * direction_z) < kCloseHit * (farther > c ? farther : c);
}

// Returns whether the origin lies on the plane of vertices relative to it, in the order of the ray's axes: their
// determinant is less than its rounding error.
__attribute__((noinline)) inline bool is_on_plane(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double determinant = 0, size = 0;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double first = a[k] * (b[i] * c[j]), second = a[k] * (b[j] * c[i]);
    determinant += first - second, size += std::fabs(first) + std::fabs(second);
  }
  return std::fabs(determinant) <= 0x1p-49 * size;
}
// Returns whether a close hit is void. Triangles entirely ahead are exempt: float tests may count them as hit.
inline bool begins_on_plane(float direction_z, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double ahead = direction_z < 0 ? -1 : 1;
  return !(a.z * ahead > 0 && b.z * ahead > 0 && c.z * ahead > 0) && is_on_plane(a, b, c);
}

inline Vec3d from_origin(const ShearedRay& ray, const Vec3& v) {
  auto along = [&](int axis) { return static_cast<double>(v[axis]) - static_cast<double>(ray.origin[axis]); };
  return {along(ray.kx), along(ray.ky), along(ray.kz)};
}

inline Crossing place_crossing(const ShearedRay& ray, const Vec3& a, const Vec3& b, const Vec3& c,
                               const EdgeValues<double>& w) {
  double sum = w.a + w.b + w.c, z = ray.origin[ray.kz], az = a[ray.kz] - z, bz = b[ray.kz] - z, cz = c[ray.kz] - z;
  const float direction_z = ray.direction[ray.kz];
  float t = static_cast<float>((w.a * az + w.b * bz + w.c * cz) / (sum * direction_z));
  if (is_close_hit(t, direction_z, az, bz, cz) &&
      begins_on_plane(direction_z, from_origin(ray, a), from_origin(ray, b), from_origin(ray, c)))
    t = 0;
  return {w.b, w.c, sum, t};
}

// Tests whether and where the ray crosses the triangle. t may have any sign or be infinite; the caller bounds it.
inline bool cross_triangle(const ShearedRay& ray, const Vec3& a, const Vec3& b, const Vec3& c, Crossing* crossing) {
  float ox = ray.origin[ray.kx], oy = ray.origin[ray.ky], oz = ray.origin[ray.kz];
  float az = a[ray.kz] - oz, bz = b[ray.kz] - oz, cz = c[ray.kz] - oz;
  float ax = (a[ray.kx] - ox) - ray.shear_x * az, ay = (a[ray.ky] - oy) - ray.shear_y * az;
  float bx = (b[ray.kx] - ox) - ray.shear_x * bz, by = (b[ray.ky] - oy) - ray.shear_y * bz;
  float cx = (c[ray.kx] - ox) - ray.shear_x * cz, cy = (c[ray.ky] - oy) - ray.shear_y * cz;
  EdgeValues<float> e = edge_values(ax, ay, bx, by, cx, cy);
  if (signs_differ(e)) return false;
  if (e.a == 0 || e.b == 0 || e.c == 0) {
    EdgeValues<double> sheared = edge_values<double>(ax, ay, bx, by, cx, cy);
    if (signs_differ(sheared) || all_zero(sheared)) return false;
  }
  EdgeValues<double> w = exact_weights(ray, a, b, c);
  if (signs_differ(w) || all_zero(w)) {
    // A ray along the plane on which it begins would hit near its origin through rounding of its direction.
    if (begins_on_plane(ray.direction[ray.kz], from_origin(ray, a), from_origin(ray, b), from_origin(ray, c)))
      return false;
    w = edge_values<double>(ax, ay, bx, by, cx, cy);
  }
  *crossing = place_crossing(ray, a, b, c, w);
  return true;
}

// cross_triangle() for a ray whose float edge functions are known to have one sign, none of them zero.
inline bool cross_decided(const ShearedRay& ray, const Vec3& a, const Vec3& b, const Vec3& c, Crossing* crossing) {
  EdgeValues<double> w = exact_weights(ray, a, b, c);
  if (signs_differ(w) || all_zero(w)) return cross_triangle(ray, a, b, c, crossing);
  *crossing = place_crossing(ray, a, b, c, w);
  return true;
}

// cross_triangle() that returns a Hit. hit->triangle is unchanged, and so is all of hit without a crossing.
inline bool intersect_triangle(const ShearedRay& ray, const Vec3& a, const Vec3& b, const Vec3& c, Hit* hit) {
  Crossing crossing;
  if (!cross_triangle(ray, a, b, c, &crossing)) return false;
  hit->t = crossing.t;
  hit->u = static_cast<float>(crossing.b / crossing.sum);
  hit->v = static_cast<float>(crossing.c / crossing.sum);
  return true;
}

inline Vec3 block_vertex(const TriangleBlock& block, int vertex, int lane) {
  return {block.vertex[vertex][0][lane], block.vertex[vertex][1][lane], block.vertex[vertex][2][lane]};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
