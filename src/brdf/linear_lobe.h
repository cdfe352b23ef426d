// A lobe times the light's cosine as a linearly transformed power of a cosine, of which polygons have shares in closed
// form [Heitz, Dupuy, Hill, Neubelt 2016, "Real-time polygonal-light shading with linearly transformed cosines", secs.
// 3 and 5]: D(ω) = Dₒ(M⁻¹ω/|M⁻¹ω|) |M⁻¹|/|M⁻¹ω|³ with Dₒ(ω) = (m + 1)/2π z^m above the plane z = 0. Unlike there,
// m is not always 1: GGX's long tails are those of a cosine, Phong's short ones nearly those of its ninth power, where
// a cosine would put 18 % of the light elsewhere. The transforms are fitted to our own lobes (linear_lobe_table.h),
// with parameters that change slowly from entry to entry:
// - GGX: x and y are slopes of directions, x = (cot − b tan θ) g²/(α c) for light in the viewer's plane whose slope is
//   `cot`, where c = cos θ, y likewise over α t; the plane z = 0 is the horizon, turned away from the viewer by k sin
//   θ;
// - Phong: z is the mirrored direction, tilted towards the normal by b; x and y are measured in α a and α t.
// The part of D below the horizon is removed: `albedo` is the lobe's, divided by the share of D above.
#pragma once
#include <cmath>
#include <cstdint>

#include "brdf/brdf.h"
#include "brdf/directions.h"
#include "brdf/linear_lobe_table.h"

namespace pocketray {

constexpr float kLinearCosineMin = 0.01f;  // viewers nearer to the horizon read this table entry

// Factor by which the peak of D × albedo may exceed the lobe's bound; linear_lobe_has_a_bounded_peak.
constexpr float kLinearPeakMax = 1.1f;
static_assert(kPhongLinearPower % 2 == 1, "odd powers have closed forms without the polygon's solid angle");
static_assert(kPhongLinearAlphaMax < 0.5626 && sizeof kPhongLinear / sizeof kPhongLinear[0] == 11,
              "√α from 0.1 to 0.75");

// Interpolates a table's parameters. Rows: √α from 0.1 in equal steps, below which lobes only get narrower; columns:
// √cos θ from 0.1 to 1.
template <class T, std::size_t kRows, std::size_t kColumns, std::size_t kCount>
void find_linear_parameters(const std::uint16_t (&table)[kRows][kColumns][kCount], T step, T alpha, T cosine,
                            T (&found)[kCount]) {
  static_assert(kRows >= 2 && kColumns >= 2, "entries to interpolate between");
  auto place = [](T x, std::size_t side, std::size_t* index) {
    const T last = static_cast<T>(side - 1);
    x = x > 0 ? x < last ? x : last : T(0);
    *index = static_cast<std::size_t>(x);
    if (*index > side - 2) *index = side - 2;
    return x - static_cast<T>(*index);
  };
  std::size_t i, j;
  const T row = place((std::sqrt(alpha) - T(0.1)) / step, kRows, &i);
  const T column = place((std::sqrt(cosine) - T(0.1)) * (static_cast<T>(kColumns - 1) / T(0.9)), kColumns, &j);
  for (std::size_t k = 0; k < kCount; ++k) {
    auto at = [&](std::size_t r, std::size_t c) { return static_cast<T>(table[i + r][j + c][k]); };
    const T low = at(0, 0) + (at(0, 1) - at(0, 0)) * column, high = at(1, 0) + (at(1, 1) - at(1, 0)) * column;
    found[k] = (low + (high - low) * row) * T(kLinearUnit);
  }
}

// Unit vectors in the surface relative to the viewer's plane: away from the viewer and across.
template <class T>
struct ViewerPlane {
  Vec3T<T> along, across;
  T cosine, sine;

  ViewerPlane(const Vec3T<T>& normal, const Vec3T<T>& to_viewer) : cosine(dot(normal, to_viewer)) {
    const Vec3T<T> away = normal * cosine - to_viewer;
    const T square = dot(away, away);
    sine = std::sqrt(square);
    if (square > T(1e-12)) {
      along = away * (1 / sine);
    } else {                                                                   // lobes are round there
      const T sign = normal.z < 0 ? T(-1) : T(1), a = -1 / (sign + normal.z);  // [Duff et al. 2017, listing 3]
      along = {1 + sign * normal.x * normal.x * a, sign * (normal.x * normal.y * a), -sign * normal.x};
    }
    across = cross(normal, along);
  }
};

// GGX's lobe of light scattered once, for parameters g, 1/t, b and k; and the share of D above the horizon.
template <class T>
void set_ggx_lobe(const Vec3T<T>& normal, const ViewerPlane<T>& plane, T alpha, const T (&p)[4], LobePartsT<T>* parts,
                  T* above) {
  const T c = plane.cosine > T(kLinearCosineMin) ? plane.cosine : T(kLinearCosineMin);
  const T scale = p[0] * p[0] / (c * alpha), middle = p[2] * plane.sine / c, turn = p[3] * plane.sine;
  parts->x = (plane.along - normal * middle) * scale;
  parts->y = plane.across * (p[1] / alpha);
  parts->z = normal + plane.along * turn;
  // M turns the horizon's normal into (turn, scale), which cuts a lune out of D.
  *above = (1 + scale / std::sqrt(scale * scale + turn * turn)) / 2;
}

// Phong's lobe, for parameters 1/a, 1/t and b; α = √(2/(n + 2)) for the exponent n.
template <class T>
void set_phong_lobe(const Vec3T<T>& normal, const ViewerPlane<T>& plane, T alpha, const T (&p)[4],
                    LobePartsT<T>* parts) {
  const T x = plane.sine, z = plane.cosine + p[2] * alpha, inverse = 1 / std::sqrt(x * x + z * z);
  parts->x = (plane.along * z - normal * x) * (inverse * p[0] / alpha);
  parts->y = plane.across * (p[1] / alpha);
  parts->z = (plane.along * x + normal * z) * inverse;
}

}  // namespace pocketray
