#include "desktop/radiosity/form_factor.h"

#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "shade/form_factor.h"

namespace pocketray {
namespace {

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
  const std::uint32_t count = static_cast<std::uint32_t>(polygon.size());
  thread_local Polygon seen, clipped;
  seen.clear();
  for (const Vec3d& corner : polygon) seen.push_back(corner - point);
  clipped.resize(2 * polygon.size());
  const std::uint32_t kept = clip_to_horizon(seen.data(), count, normal, clipped.data());
  const double factor = form_factor_above_horizon(clipped.data(), kept, normal);
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
