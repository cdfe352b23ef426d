#include "radiosity/form_factor.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

// The angle between two vectors, accurate when it is small [Kahan 2006]; not their unit vectors' arc cosine.
double angle_between(const Vec3d& a, const Vec3d& b) {
  Vec3d u = a * length(b), v = b * length(a);
  double sum = length(u + v), difference = length(u - v);
  if (!(sum > 0)) return kPi;
  // 2·atan(difference / sum), by the arc cosine of the half angle or of its complement, whichever is well conditioned.
  double size = std::sqrt(sum * sum + difference * difference);
  return difference < sum ? kPi - 2 * det_acos(difference / size) : 2 * det_acos(sum / size);
}

// The part of a polygon, relative to the point, above the horizon.
void clip_to_horizon(const Vec3d& point, const Vec3d& normal, const Polygon& polygon, Polygon* clipped) {
  clipped->clear();
  const std::size_t count = polygon.size();
  for (std::size_t i = 0; i < count; ++i) {
    Vec3d a = polygon[i] - point, b = polygon[(i + 1) % count] - point;
    double above_a = dot(a, normal), above_b = dot(b, normal);
    if (above_a >= 0) clipped->push_back(a);
    if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0))
      clipped->push_back(a + (b - a) * (above_a / (above_a - above_b)));
  }
}

Vec3d normal_of(const Polygon& polygon) {
  Vec3d sum = {0, 0, 0};
  for (std::size_t i = 2; i < polygon.size(); ++i) sum += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return sum;
}

// ∫ ln|p − (a + (b − a)t)|² dt over [0, 1], in closed form.
double log_integral(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double size = length(along);
  const Vec3d unit = along / size, way = p - a;
  const double foot = dot(way, unit), near = -foot, far = size - foot;
  const Vec3d beside = way - unit * foot;
  const double square = dot(beside, beside), height = std::sqrt(square);
  auto part = [&](double x) {  // ∫ ln(x² + h²) dx
    const double r = x * x + square;
    if (!(r > 0)) return 0.0;
    return x * det_log(r) - 2 * x + (height > 0 ? 2 * height * (kPi / 2 - det_acos(x / std::sqrt(r))) : 0.0);
  };
  return (part(far) - part(near)) / size;
}

struct Edge {
  Vec3d a, b;
};

// ∫ over the edge of the other polygon's inner integral, dot product of the edges included.
double gauss(const Edge& outer, double begin, double end, const Polygon& inner) {
  constexpr double kPlace[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr double kWeight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
  const Vec3d along = outer.b - outer.a;
  double sum = 0;
  for (int k = 0; k < 4; ++k)
    for (int sign = -1; sign <= 1; sign += 2) {
      const double t = 0.5 * (begin + end) + 0.5 * (end - begin) * sign * kPlace[k];
      const Vec3d p = outer.a + along * t;
      double value = 0;
      for (std::size_t i = 0; i < inner.size(); ++i) {
        const Vec3d &a = inner[i], &b = inner[(i + 1) % inner.size()];
        const double facing = dot(along, b - a);
        if (facing != 0) value += facing * log_integral(p, a, b);
      }
      sum += kWeight[k] * value;
    }
  return sum * 0.5 * (end - begin);
}

// Halves the interval until both halves agree with the whole: the integrand has an integrable singularity where
// polygons touch.
double adaptive(const Edge& outer, double begin, double end, const Polygon& inner, double whole, double tolerance,
                int depth) {
  const double middle = 0.5 * (begin + end);
  const double left = gauss(outer, begin, middle, inner), right = gauss(outer, middle, end, inner);
  if (depth == 0 || std::fabs(left + right - whole) <= tolerance) return left + right;
  return adaptive(outer, begin, middle, inner, left, tolerance, depth - 1) +
         adaptive(outer, middle, end, inner, right, tolerance, depth - 1);
}

}  // namespace

double polygon_area(const Polygon& polygon) { return 0.5 * length(normal_of(polygon)); }

double point_form_factor(const Vec3d& point, const Vec3d& normal, const Polygon& polygon) {
  CHECK(polygon.size() >= 3);
  if (!(dot(normal_of(polygon), point - polygon[0]) > 0)) return 0;
  thread_local Polygon clipped;
  clip_to_horizon(point, normal, polygon, &clipped);
  double sum = 0;
  for (std::size_t i = 0; i < clipped.size(); ++i) {
    const Vec3d &a = clipped[i], &b = clipped[(i + 1) % clipped.size()];
    const Vec3d axis = cross(b, a);
    const double size = length(axis);
    if (size > 0) sum += angle_between(a, b) * dot(axis, normal) / size;
  }
  const double factor = sum / (2 * kPi);
  return factor > 0 ? factor < 1 ? factor : 1 : 0;
}

double polygon_form_factor(const Polygon& from, const Polygon& to) {
  CHECK(from.size() >= 3 && to.size() >= 3);
  const double area = polygon_area(from), scale = std::sqrt(area * polygon_area(to));
  if (!(scale > 0)) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Edge edge = {from[i], from[(i + 1) % from.size()]};
    sum += adaptive(edge, 0, 1, to, gauss(edge, 0, 1, to), 1e-11 * scale, 24);
  }
  const double factor = std::fabs(sum) / (4 * kPi * area);  // ln r is half of ln r²
  return factor < 1 ? factor : 1;
}

double coaxial_disk_form_factor(double from, double to, double distance) {
  CHECK(from > 0 && to >= 0);
  const double h = distance / from, ratio = to / from;
  const double sum = 1 + h * h + ratio * ratio;
  return 2 * ratio * ratio / (sum + std::sqrt(sum * sum - 4 * ratio * ratio));
}

}  // namespace pocketray
