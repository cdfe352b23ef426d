// Smooth boundaries between dielectrics: Snell's law and the exact Fresnel equations.
#pragma once
#include "base/vec3.h"

namespace pocketray {

// Reflectance of unpolarised light at a boundary, for cos_i ∈ [0, 1] and relative index eta = n_from / n_to
// [Born & Wolf 1999, sec. 1.5.2, eqs. 21]. Sets *cos_t, the cosine of the refracted ray; total internal reflection
// gives 1 and cos_t = 0.
inline float fresnel(float cos_i, float eta, float* cos_t) {
  if (cos_i > 1) cos_i = 1;
  float sin2_t = eta * eta * ((1 - cos_i) * (1 + cos_i));
  if (!(sin2_t < 1)) {
    *cos_t = 0;
    return 1;
  }
  *cos_t = std::sqrt(1 - sin2_t);
  float s = (eta * cos_i - *cos_t) / (eta * cos_i + *cos_t);
  float p = (cos_i - eta * *cos_t) / (cos_i + eta * *cos_t);
  return 0.5f * (s * s + p * p);
}

// d mirrored in the plane with unit normal n.
inline Vec3 reflect(const Vec3& d, const Vec3& n) { return d - n * (2 * dot(d, n)); }
// d refracted. n is on the side that d comes from, cos_i = −d·n, cos_t from fresnel().
inline Vec3 refract(const Vec3& d, const Vec3& n, float eta, float cos_i, float cos_t) {
  return d * eta + n * (eta * cos_i - cos_t);
}

}  // namespace pocketray
