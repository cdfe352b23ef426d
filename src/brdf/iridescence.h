// Reflectance of a thin film over a material: waves reflected by its upper and its lower boundary interfere
// [Belcour & Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence"], with
// the approximations of KHR_materials_iridescence: Schlick's Fresnel at both boundaries, no polarisation, two orders of
// interference, and a base whose index follows from its reflectance.
#pragma once
#include <cmath>

#include "base/fmath.h"
#include "scene/scene.h"

namespace pocketray {

inline const Iridescence* iridescence_of(const Scene& scene, std::uint32_t material) {
  return scene.iridescences.count && scene.iridescences[material].strength > 0 ? &scene.iridescences[material]
                                                                               : nullptr;
}

template <class T>
T film_schlick(T f0, T cosine) {
  const T x = 1 - cosine;
  return f0 + (1 - f0) * (x * x * x * x * x);
}

// Response of linear sRGB to a wave with a path difference (nanometres) and a phase shift for each channel: the Fourier
// transform of the CIE's functions as sums of Gaussians (sec. 4, and its code).
template <class T>
Vec3T<T> film_sensitivity(T path, const Vec3T<T>& shift) {
  const double phase = 2 * kPi * static_cast<double>(path) * 1e-9;
  auto wave = [&](double value, double position, double variance, T offset) {
    return value * std::sqrt(2 * kPi * variance) * det_cos(position * phase + static_cast<double>(offset)) *
           det_exp(-phase * phase * variance) * (1 / 1.0685e-7);
  };
  const double x = wave(5.4856e-13, 1.6810e6, 4.3278e9, shift.x) + wave(9.7470e-14, 2.2399e6, 4.5282e9, shift.x);
  const double y = wave(4.4201e-13, 1.7953e6, 9.3046e9, shift.y), z = wave(5.2481e-13, 2.2084e6, 6.6121e9, shift.z);
  return {static_cast<T>(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          static_cast<T>(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          static_cast<T>(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

// Reflectance in air at a cosine from the normal of a film of an index and a thickness (nanometres), over a base of
// reflectance f0 at normal incidence; 0 to 1.
template <class T>
Vec3T<T> film_reflectance(T ior, T thickness, const Vec3T<T>& f0, T cosine) {
  // Without thickness, the film vanishes.
  T s = thickness * T(1 / 0.03);
  s = s < 1 ? s * s * (3 - 2 * s) : T(1);
  const T index = 1 + (ior - 1) * s;
  const T cos1 = cosine < 1 ? cosine : T(1), cos2_square = 1 - (1 - cos1 * cos1) / (index * index);
  const T cos2 = std::sqrt(cos2_square > 0 ? cos2_square : T(0)), root = (index - 1) / (index + 1);
  const T r12 = film_schlick(root * root, cos1), t121 = 1 - r12, path = 2 * index * thickness * cos2;
  constexpr T half_wave = static_cast<T>(kPi);
  Vec3T<T> r123, reflected, shift;
  for (int c = 0; c < 3; ++c) {
    const T base = std::sqrt(f0[c] > 0 ? f0[c] < T(0.9999) ? f0[c] : T(0.9999) : T(0));
    const T base_index = (1 + base) / (1 - base), step = (base_index - index) / (base_index + index);
    const T r23 = film_schlick(step * step, cos2), both = r12 * r23;
    r123[c] = both < T(0.9999) ? both : T(0.9999);
    reflected[c] = t121 * t121 * r23 / (1 - r123[c]);
    shift[c] = half_wave + (base_index < index ? half_wave : T(0));  // of the film's inner sides
    r123[c] = std::sqrt(r123[c]);
  }
  Vec3T<T> sum = reflected + Vec3T<T>{r12, r12, r12}, order = reflected - Vec3T<T>{t121, t121, t121};
  for (int m = 1; m <= 2; ++m) {
    const T times = static_cast<T>(m);
    order = order * r123;
    sum += order * film_sensitivity(path * times, shift * times) * T(2);
  }
  for (int c = 0; c < 3; ++c) sum[c] = sum[c] > 0 ? sum[c] < 1 ? sum[c] : T(1) : T(0);
  return sum;
}

// Reflectance at normal incidence of the lobe that Schlick's formula takes to this reflectance at the cosine.
template <class T>
Vec3T<T> film_f0(const Vec3T<T>& reflectance, T cosine) {
  const T x = 1 - (cosine < 1 ? cosine : T(1)), x5 = x * x * x * x * x;
  const T grazing = x5 < T(0.9999) ? x5 : T(0.9999);
  Vec3T<T> f0;
  for (int c = 0; c < 3; ++c) {
    const T value = (reflectance[c] - grazing) / (1 - grazing);
    f0[c] = value > 0 ? value : T(0);
  }
  return f0;
}

}  // namespace pocketray
