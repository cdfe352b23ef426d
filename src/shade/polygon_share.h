// Share of a linearly transformed power of a cosine (brdf/linear_lobe.h) that falls into a polygon, as float and, for
// the reference, as double.
#pragma once
#include <cmath>

#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/brdf.h"
#include "shade/form_factor.h"

namespace pocketray {

// atan(x) / x for a square x² in [0, 1], with a relative error of 1e-7: a minimax fit.
inline float arc_ratio(float square) {
  const float high = ((-0.00469327345f * square + 0.0242523942f) * square - 0.0594863817f) * square + 0.0991429240f;
  return (((high * square - 0.140194803f) * square + 0.199697241f) * square - 0.333319902f) * square + 0.999999881f;
}

// Angle between two vectors divided by the length of their cross product (not 0): from its tangent, or from its
// complement's if the angle is close to 90 degrees.
inline float angle_over_cross(float cross_square, float dot_product) {
  const float dot_square = dot_product * dot_product;
  if (cross_square <= dot_square) {
    const float inverse = 1 / dot_product, ratio = arc_ratio(cross_square * inverse * inverse) * inverse;
    return dot_product > 0 ? ratio : kPiF / std::sqrt(cross_square) + ratio;
  }
  const float inverse = 1 / std::sqrt(cross_square), x = dot_product * inverse;
  return (kPiF / 2 - x * arc_ratio(x * x)) * inverse;
}
inline double angle_over_cross(double cross_square, double dot_product) {
  const double size = std::sqrt(cross_square), hypotenuse = std::sqrt(cross_square + dot_product * dot_product);
  if (size > std::fabs(dot_product)) return det_acos(dot_product / hypotenuse) / size;
  const double acute = kPi / 2 - det_acos(size / hypotenuse);
  return (dot_product > 0 ? acute : kPi - acute) / size;
}

// Both sums run over edges from a to b, unit vectors; Γ = a × b / |a × b| is the normal of their plane and z the cosine
// that is raised to a power. By Stokes, (m + 1) ∫ zᵐ dω over a polygon is (m − 1) ∫ zᵐ⁻² dω plus Γz ∫ zᵐ⁻¹ ds over its
// edges [Arvo 1995, "Applications of irradiance tensors", eq. 12]. In total, it is Γz times the sum of the integrals of
// even powers below m; and k ∫ zᵏ ds = (k − 1)(1 − Γz²) ∫ zᵏ⁻² ds − [zᵏ⁻¹ dz/ds].
template <class T>
T edge_moment(std::uint32_t power, const Vec3T<T>& a, const Vec3T<T>& b) {
  const Vec3T<T> across = cross(a, b);
  const T square = dot(across, across);
  if (!(square > 0)) return 0;
  T integral = angle_over_cross(square, dot(a, b)), sum = integral;  // both divided by |a × b|
  if (power == 1) return sum * across.z;
  const T inverse = 1 / square, rise = (across.x * across.x + across.y * across.y) * inverse;
  const T square_a = a.z * a.z, square_b = b.z * b.z;
  T end_a = a.z * (across.x * a.y - across.y * a.x) * inverse,
    end_b = b.z * (across.x * b.y - across.y * b.x) * inverse;
  for (std::uint32_t k = 2; k < power; k += 2) {
    integral = (static_cast<T>(k - 1) * rise * integral - (end_b - end_a)) * (1 / static_cast<T>(k));
    sum += integral;
    end_a *= square_a, end_b *= square_b;
  }
  return sum * across.z;
}

// Share of the distribution in a polygon above the horizon of a normal. Corners are relative to the point; none exceeds
// 2¹⁰ by much.
template <class T>
T linear_share(const LobePartsT<T>& lobe, std::uint32_t power, const Vec3T<T>* corners, std::uint32_t count,
               const Vec3T<T>& normal) {
  Vec3T<T> above[2 * kLightCornerMax], clipped[4 * kLightCornerMax];
  count = clip_to_horizon(corners, count, normal, above);
  for (std::uint32_t i = 0; i < count; ++i)
    above[i] = {dot(lobe.x, above[i]), dot(lobe.y, above[i]), dot(lobe.z, above[i])};
  count = clip_to_horizon(above, count, {0, 0, 1}, clipped);
  for (std::uint32_t i = 0; i < count; ++i) {
    const T square = dot(clipped[i], clipped[i]);
    clipped[i] = square > 0 ? clipped[i] * (1 / std::sqrt(square)) : Vec3T<T>{0, 0, 0};
  }
  T sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) sum += edge_moment(power, clipped[i], clipped[i + 1 < count ? i + 1 : 0]);
  const T share = std::fabs(sum) * static_cast<T>(0.5 / kPi);
  return share < 1 ? share : T(1);
}

}  // namespace pocketray
