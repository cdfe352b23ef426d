// The independent oracle: brute force in double, by a method other than the renderer's. A ray is projected along
// itself; how far it passes inside or outside each triangle is a distance in the perpendicular plane. Float arithmetic
// may only err where that distance is below a given band.
#pragma once
#include <cmath>

#include "accel/accel_world.h"
#include "accel/triangle.h"

namespace pocketray {

constexpr double kFloatUlp = 0x1p-23;

enum class Verdict { miss, hit, open };  // open: inside the band, either answer is correct

// Signed distance in the plane from the origin to a triangle: positive inside, ≤ 0 outside.
inline double inside_distance(const double (&x)[3], const double (&y)[3]) {
  double area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  double least = std::numeric_limits<double>::infinity(), nearest = least;
  for (int i = 0; i < 3; ++i) {
    int j = (i + 1) % 3;
    double ex = x[j] - x[i], ey = y[j] - y[i], length2 = ex * ex + ey * ey;
    double s = length2 > 0 ? std::fmin(1.0, std::fmax(0.0, -(x[i] * ex + y[i] * ey) / length2)) : 0;
    nearest = std::fmin(nearest, std::hypot(x[i] + s * ex, y[i] + s * ey));
    double side = (x[i] * ey - y[i] * ex) * (area < 0 ? -1 : 1);
    least = std::fmin(least, length2 > 0 ? side / std::sqrt(length2) : 0);
  }
  return area != 0 && least > 0 ? nearest : -nearest;
}

struct OracleHit {
  Verdict verdict;
  double t, t_error;  // crossing of the plane, and how far a lateral error within the band can move it
};

// The band is `ulps` float ulp of the farthest vertex's distance from the ray's origin.
inline OracleHit oracle_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c, double ulps) {
  Vec3d d = to_double(ray.direction), o = to_double(ray.origin), across = {0, 0, 0};
  across[std::fabs(d.x) < std::fabs(d.y) ? (std::fabs(d.x) < std::fabs(d.z) ? 0 : 2)
                                         : (std::fabs(d.y) < std::fabs(d.z) ? 1 : 2)] = 1;
  Vec3d forward = normalize(d), right = normalize(cross(forward, across)), up = cross(right, forward);
  Vec3d p[3] = {to_double(a) - o, to_double(b) - o, to_double(c) - o};
  double x[3], y[3], far = 0;
  for (int i = 0; i < 3; ++i) {
    x[i] = dot(p[i], right), y[i] = dot(p[i], up);
    far = std::fmax(far, max_component(Vec3d{std::fabs(p[i].x), std::fabs(p[i].y), std::fabs(p[i].z)}));
  }
  double band = ulps * kFloatUlp * far, inside = inside_distance(x, y);
  Vec3d n = normalize(cross(p[1] - p[0], p[2] - p[0]));
  double slope = std::fabs(dot(n, forward)), size = std::sqrt(dot(d, d));
  double t = dot(n, p[0]) / dot(n, d);
  return {inside > band ? Verdict::hit : inside < -band ? Verdict::miss : Verdict::open, t, band / (slope * size)};
}

// Checks one answer of closest() against all triangles of the mesh. True if it is correct or the oracle cannot tell.
// *decided counts the rays that the oracle could decide.
inline bool oracle_agrees(const World& world, const Ray& ray, const Hit& found, double ulps, int* decided) {
  double nearest = std::numeric_limits<double>::infinity(), second = nearest, open = nearest;
  std::uint32_t id = kNoTriangle;
  for (std::uint32_t i = 0; i < world.triangles.size(); ++i) {
    const Triangle& triangle = world.triangles[i];
    if (!is_hittable(world.accel.positions, triangle)) continue;
    OracleHit hit = oracle_triangle(ray, world.positions[triangle.vertex(0)], world.positions[triangle.vertex(1)],
                                    world.positions[triangle.vertex(2)], ulps);
    if (hit.verdict == Verdict::miss) continue;
    double margin = hit.t_error + 4 * kFloatUlp * std::fabs(hit.t);
    if (!std::isfinite(hit.t + margin)) {  // the ray lies in the plane: it may meet the triangle anywhere
      open = 0;
      continue;
    }
    if (!(hit.t - margin < ray.t_max) || !(hit.t + margin > 0)) continue;
    bool sure = hit.verdict == Verdict::hit && hit.t - margin > 0 && hit.t + margin < ray.t_max;
    if (!sure) {
      open = std::fmin(open, hit.t - margin);
    } else if (hit.t < nearest) {
      second = nearest, nearest = hit.t, id = i;
    } else {
      second = std::fmin(second, hit.t);
    }
  }
  double tie = nearest * (1 + 8 * kFloatUlp);
  if (id == kNoTriangle && open == std::numeric_limits<double>::infinity()) return ++*decided, found.triangle == id;
  if (id == kNoTriangle || open <= tie) return true;  // any answer may be correct
  ++*decided;
  if (found.triangle == kNoTriangle) return false;
  bool t_right = std::fabs(found.t - nearest) <= 8 * kFloatUlp * nearest;
  return t_right && (found.triangle == id || second <= tie);
}

}  // namespace pocketray
