// Directions around an axis in double precision, for sampling lobes.
#pragma once
#include <cmath>

#include "base/fmath.h"
#include "base/vec3.h"

namespace pocketray {

// Two unit vectors that span the plane normal to the unit vector n [Duff et al. 2017, listing 3].
inline void make_basis(const Vec3d& n, Vec3d* tangent, Vec3d* bitangent) {
  double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  *tangent = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *bitangent = {b, sign + n.y * n.y * a, -n.y};
}

// x^y for x in [0, 1].
inline double unit_power(double x, double y) { return y == 0 ? 1 : x > 0 ? det_exp(y * det_log(x)) : 0; }

// Direction with the density (n + 1)/2π cosⁿ of its angle with the axis, over the sphere.
inline Vec3d power_cosine_direction(const Vec3d& axis, double n, double u, double v) {
  double cosine = n == 1 ? std::sqrt(1 - u) : unit_power(1 - u, 1 / (n + 1)), phi = 2 * kPi * v;
  double sine = std::sqrt((1 - cosine) * (1 + cosine));
  Vec3d tangent, bitangent;
  make_basis(axis, &tangent, &bitangent);
  return tangent * (sine * det_cos(phi)) + bitangent * (sine * det_sin(phi)) + axis * cosine;
}

}  // namespace pocketray
