// The sheen of cloth over a material, layered as KHR_materials_sheen has it: light scattered by upright fibres.
//   seen = base × (1 − max(colour) E(n·v)) + colour × f,  f = D / 4 (n·l n·v + n·l w(n·v) + n·v w(n·l))
//   D = (2 + 1/α) sin^(1/α) / 2π for the angle between normal and half vector, α = r² for the roughness r
// [Estevez & Kulla 2017, "Production friendly microfacet sheen BRDF", eqs. 2 and 3], where w(x) = x Λ(x) is tabulated.
// Their fit reflects up to 2.9 times the light that arrives: where it would exceed .95 of it, at grazing angles and
// mostly below r = .3, w is larger. E is the albedo of f; the table is nowhere below it. Lights meet f; light from
// everywhere (ambient, environment, indirect) is reflected as by a matte surface of albedo colour × E(n·v).
#pragma once
#include <cmath>

#include "base/fmath.h"
#include "brdf/microfacet.h"
#include "brdf/sheen_table.h"

namespace pocketray {

constexpr float kSheenRoughnessMin = 0.07f;  // smoother sheens are as this one
constexpr float kSheenCosineMin = 1e-6f;     // in f, which is infinite where both cosines are 0
constexpr float kSheenSumMin = 0.6f;         // lower bound of n·v + w(n·v), by the table

// Position between two of the table's rows or columns; x in [0, 1].
template <class T>
struct SheenCell {
  int index;
  T rest;
  explicit SheenCell(T x) {
    const T place = (x > 0 ? x < 1 ? x : T(1) : T(0)) * (kSheenSide - 1);
    index = static_cast<int>(place);
    if (index > kSheenSide - 2) index = kSheenSide - 2;
    rest = place - static_cast<T>(index);
  }
};
template <class T>
SheenCell<T> sheen_row(T roughness) {
  constexpr T least = static_cast<T>(kSheenRoughnessMin);
  return SheenCell<T>((roughness - least) * (1 / (1 - least)));
}
// `entry`: 0 for w, 1 for the albedo, in the table's units.
template <class T>
T sheen_entry(const SheenCell<T>& row, T cosine, int entry) {
  const SheenCell<T> column(std::sqrt(cosine > 0 ? cosine : T(0)));
  auto at = [&](int r, int c) { return static_cast<T>(kSheenTable[row.index + r][column.index + c][entry]); };
  const T low = at(0, 0) + (at(0, 1) - at(0, 0)) * column.rest, high = at(1, 0) + (at(1, 1) - at(1, 0)) * column.rest;
  return low + (high - low) * row.rest;
}
template <class T>
T sheen_w(const SheenCell<T>& row, T cosine) {
  return sheen_entry(row, cosine, 0) * T(1.0 / 8192);
}

// E for a viewer at a cosine from the normal.
template <class T>
T sheen_albedo(T roughness, T cos_viewer) {
  return sheen_entry(sheen_row(roughness), std::fabs(cos_viewer), 1) * T(1.0 / 65535);
}

inline float sheen_power(float x, float y) { return det_pow(x, y); }
inline double sheen_power(double x, double y) { return unit_power(x, y); }

template <class T>
T sheen_exponent(T roughness) {
  constexpr T least = static_cast<T>(kSheenRoughnessMin);
  const T r = roughness > least ? roughness : least;
  return 1 / (r * r);
}

// f, 1/sr. Vectors are as in BrdfInfo.
template <class T>
T sheen_value(T roughness, const Vec3T<T>& normal, const Vec3T<T>& viewer, const Vec3T<T>& to_light) {
  const T cos_light = dot(normal, to_light);
  if (!(cos_light > 0)) return 0;
  const Vec3T<T> to_viewer = above_horizon(normal, viewer), sum = to_viewer + to_light, across = cross(normal, sum);
  const T square = dot(sum, sum), cos_viewer = dot(normal, to_viewer), least = static_cast<T>(kSheenCosineMin);
  if (!(square > 0)) return 0;
  const T l = cos_light > least ? cos_light : least, v = cos_viewer > least ? cos_viewer : least;
  const T sine_square = dot(across, across) / square, exponent = sheen_exponent(roughness);
  const SheenCell<T> row = sheen_row(roughness);
  const T density =
      (2 + exponent) * static_cast<T>(0.5 / kPi) * sheen_power(sine_square < 1 ? sine_square : T(1), exponent / 2);
  return density / (4 * (l * v + l * sheen_w(row, v) + v * sheen_w(row, l)));
}

// Upper bound of f × the light's cosine for that roughness and above.
inline float sheen_peak(float roughness) {
  return (2 + sheen_exponent(roughness)) * (0.5f / kPiF) / (4 * kSheenSumMin) * 1.00001f;  // covers rounding
}

inline const Sheen* sheen_of(const Scene& scene, std::uint32_t material) {
  return scene.sheens.count && !is_zero(scene.sheens[material].color) ? &scene.sheens[material] : nullptr;
}

}  // namespace pocketray
