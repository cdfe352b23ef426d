#include "shade/form_factor.h"

#include <cmath>

#include "base/fmath.h"

namespace pocketray {
namespace {

// Angle between two vectors, accurate for small angles [Kahan 2006], unlike the arc cosine of a dot product.
double angle_between(const Vec3d& a, const Vec3d& b) {
  Vec3d u = a * length(b), v = b * length(a);
  double sum = length(u + v), difference = length(u - v);
  if (!(sum > 0)) return kPi;
  // 2·atan(difference / sum), by the arc cosine of the half angle or of its complement, whichever is well conditioned.
  double size = std::sqrt(sum * sum + difference * difference);
  return difference < sum ? kPi - 2 * det_acos(difference / size) : 2 * det_acos(sum / size);
}

}  // namespace

double form_factor_above_horizon(const Vec3d* corners, std::uint32_t count, const Vec3d& normal) {
  double sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d &a = corners[i], &b = corners[i + 1 < count ? i + 1 : 0];
    const Vec3d axis = cross(b, a);
    const double size = length(axis);
    if (size > 0) sum += angle_between(a, b) * dot(axis, normal) / size;
  }
  return sum / (2 * kPi);
}

}  // namespace pocketray
