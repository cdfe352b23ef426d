// Thin films.
#include "brdf/iridescence.h"

#include <complex>

#include <doctest/doctest.h>

using namespace pocketray;

namespace {

// The CIE 1931 functions as sums of Gaussians in wavelength [Wyman et al. 2013, eqs. 4], nanometres.
double bell(double x, double middle, double left, double right) {
  const double t = (x - middle) / (x < middle ? left : right);
  return std::exp(-0.5 * t * t);
}
Vec3d cie(double l) {
  return {1.056 * bell(l, 599.8, 37.9, 31.0) + 0.362 * bell(l, 442.0, 16.0, 26.7) - 0.065 * bell(l, 501.1, 20.4, 26.2),
          0.821 * bell(l, 568.8, 46.9, 40.5) + 0.286 * bell(l, 530.9, 16.3, 31.1),
          1.217 * bell(l, 437.0, 11.8, 36.0) + 0.681 * bell(l, 459.0, 26.0, 13.8)};
}

// Linear sRGB of a spectrum under equal energy.
template <class Spectrum>
Vec3d color_of(Spectrum spectrum) {
  Vec3d sum = {0, 0, 0};
  double white = 0;
  for (int l = 360; l <= 830; ++l) sum += cie(l) * spectrum(static_cast<double>(l)), white += cie(l).y;
  sum = sum / white;
  return {3.2404542 * sum.x - 1.5371385 * sum.y - 0.4985314 * sum.z,
          -0.9692660 * sum.x + 1.8760108 * sum.y + 0.0415560 * sum.z,
          0.0556434 * sum.x - 0.2040259 * sum.y + 1.0572252 * sum.z};
}

double normal_f0(double from, double to) {
  const double root = (from - to) / (from + to);
  return root * root;
}

}  // namespace

// Goal: the response to a wave is the integral over wavelengths. Method: another fit of the CIE's functions; within the
// difference of the fits, which is larger for long paths.
TEST_CASE("film_sensitivity_integrates_over_wavelengths") {
  for (double shift : {0.0, 1.0, kPi})
    for (double path = 0; path <= 3000; path += 125) {
      const Vec3d found = film_sensitivity(path, Vec3d{shift, shift, shift});
      const Vec3d expected = color_of([&](double l) { return std::cos(2 * kPi * path / l + shift); });
      CAPTURE(path);
      CAPTURE(shift);
      for (int c = 0; c < 3; ++c) CHECK(std::fabs(found[c] - expected[c]) < (path < 600 ? 0.07 : 0.18));
    }
}

// Goal: [Airy] the reflectance seen from above is that of waves between two boundaries. Method: Airy's sum at each
// wavelength; the colours of its oscillation, about the mean over all phases. Bases of lower and higher index.
TEST_CASE("film_reflectance_is_airys") {
  for (double ior : {1.2, 1.33, 1.8})
    for (double base : {1.1, 1.5, 2.4})
      for (double thickness : {100.0, 250.0, 400.0, 600.0}) {
        const double r12 = (1 - ior) / (1 + ior), r23 = (ior - base) / (ior + base), f0 = normal_f0(1, base);
        auto airy = [&](double l) {
          const auto turn = std::polar(1.0, 4 * kPi * ior * thickness / l);
          return std::norm((r12 + r23 * turn) / (1.0 + r12 * r23 * turn));
        };
        const double both = r12 * r12 * r23 * r23,
                     mean = r12 * r12 + (1 - r12 * r12) * (1 - r12 * r12) * r23 * r23 / (1 - both);
        const Vec3d expected = color_of([&](double l) { return airy(l) - mean; });
        const Vec3d found = film_reflectance(ior, thickness, Vec3d{f0, f0, f0}, 1.0);
        CAPTURE(ior);
        CAPTURE(base);
        CAPTURE(thickness);
        for (int c = 0; c < 3; ++c) CHECK(std::fabs(found[c] - std::fmax(mean + expected[c], 0)) < 0.02);
      }
}

// Goal: without thickness there is only the base; at grazing angles everything is reflected; the lobe of a film is the
// one that Schlick's formula takes to the reflectance; floats agree with doubles. Method: these limits over a grid.
TEST_CASE("film_reflectance_has_its_limits") {
  for (double f0 : {0.02, 0.3, 0.95})
    for (double ior : {1.0, 1.4, 2.0})
      for (double thickness : {0.0, 150.0, 500.0, 2000.0})
        for (double cosine : {1.0, 0.8, 0.4, 0.1}) {
          const Vec3d base = {f0, f0 * 0.8, f0 * 0.6}, seen = film_reflectance(ior, thickness, base, cosine);
          const float f = static_cast<float>(f0);
          const Vec3 in_floats = film_reflectance(static_cast<float>(ior), static_cast<float>(thickness),
                                                  Vec3{f, f * 0.8f, f * 0.6f}, static_cast<float>(cosine));
          const Vec3d lobe = film_f0(seen, cosine);
          CAPTURE(f0);
          CAPTURE(ior);
          CAPTURE(thickness);
          CAPTURE(cosine);
          for (int c = 0; c < 3; ++c) {
            CHECK((seen[c] >= 0 && seen[c] <= 1 && lobe[c] >= 0 && lobe[c] <= 1));
            CHECK(static_cast<double>(in_floats[c]) == doctest::Approx(seen[c]).epsilon(1e-3));
            if (thickness == 0 && cosine == 1) CHECK(seen[c] == doctest::Approx(base[c]).epsilon(1e-9));
            if (lobe[c] > 0) CHECK(film_schlick(lobe[c], cosine) == doctest::Approx(seen[c]).epsilon(1e-9));
          }
          CHECK(film_reflectance(ior, thickness, base, 0.0).y == doctest::Approx(1).epsilon(1e-3));
        }
}
