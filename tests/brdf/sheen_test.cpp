// The sheen of cloth.
#include <doctest/doctest.h>

#include "base/rng.h"
#include "brdf/sheen.h"

using namespace pocketray;

namespace {

Vec3d at(double cosine, double turn) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}
const Vec3d kNormal = {0, 0, 1};

// Integral of the value × cosine over the hemisphere, finer at the horizon.
double albedo_of(double roughness, double cosine) {
  constexpr int kRings = 240, kSectors = 120;
  const Vec3d v = at(cosine, 0);
  double sum = 0;
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kSectors; ++k) {
      const double t = (i + 0.5) / kRings, l = t * t;
      sum += sheen_value(roughness, kNormal, v, at(l, kPi * (k + 0.5) / kSectors)) * l * 2 * t;
    }
  return sum * 2 * kPi / kRings / kSectors;
}

// Λ [Estevez & Kulla 2017, eq. 4 and table 1] with the C library.
double lambda(double x, double alpha) {
  auto exponent = [alpha](double cosine) {
    const double p = (1 - alpha) * (1 - alpha);
    auto mix = [p](double rough, double smooth) { return rough + (smooth - rough) * p; };
    return mix(21.5473, 25.3245) / (1 + mix(3.82987, 3.32435) * std::pow(cosine, mix(0.19823, 0.16801))) +
           mix(-1.97760, -1.27393) * cosine + mix(-4.32054, -4.85967);
  };
  return x < 0.5 ? std::exp(exponent(x)) : std::exp(2 * exponent(0.5) - exponent(1 - x));
}

}  // namespace

// Goal: away from grazing angles and from low roughness, the sheen is that of Estevez and Kulla. Method: their formulas
// with the C library; the table's interpolation errs by up to 2 %.
TEST_CASE("sheen_is_that_of_its_paper") {
  for (double r : {0.35, 0.5, 0.77, 1.0})
    for (double v : {0.1, 0.35, 0.7, 0.97})
      for (double l : {0.1, 0.3, 0.6, 0.95})
        for (double turn : {0.0, 1.0, 2.2, 3.0}) {
          const Vec3d to_viewer = at(v, 0.4), to_light = at(l, 0.4 + turn), half = normalize(to_viewer + to_light);
          const double alpha = r * r, sine = std::sqrt(1 - half.z * half.z);
          const double density = (2 + 1 / alpha) * std::pow(sine, 1 / alpha) / (2 * kPi);
          const double expected = density / ((1 + lambda(v, alpha) + lambda(l, alpha)) * 4 * v * l);
          CAPTURE(r);
          CAPTURE(v);
          CAPTURE(l);
          CHECK(sheen_value(r, kNormal, to_viewer, to_light) == doctest::Approx(expected).epsilon(0.02));
        }
}

// Goal: [white furnace] a white sheen reflects at most the light that arrives, and its base gets no more than the rest.
// Method: integrals of the value against the table, on and between its entries, down to the smoothest.
TEST_CASE("sheen_returns_no_more_light_than_arrives") {
  for (double r : {0.0, 0.07, 0.1, 0.16, 0.22, 0.3, 0.41, 0.55, 0.7, 0.93, 1.0})
    for (double root : {0.001, 0.03, 0.08, 0.14, 0.2, 0.27, 0.4, 0.58, 0.75, 0.9, 1.0}) {
      const double cosine = root * root, table = sheen_albedo(r, cosine), found = albedo_of(r, cosine);
      CAPTURE(r);
      CAPTURE(cosine);
      CHECK(found <= table + 1e-3);
      CHECK(table < 0.98);
      CHECK(table - found < (r < 0.25 ? 0.12 : cosine < 0.005 ? 0.09 : 0.025));
      CHECK(sheen_albedo(static_cast<float>(r), static_cast<float>(-cosine)) == doctest::Approx(table).epsilon(1e-3));
    }
}

// Goal: the kernel's value is that in double precision, reciprocal, and below its bound, at any angle. Method: random
// directions, many of them grazing.
TEST_CASE("sheen_is_reciprocal_and_bounded") {
  Rng rng = make_rng(4);
  for (int i = 0; i < 20000; ++i) {
    auto cosine = [&] { return std::pow(next_double(&rng), 1 + 8 * next_double(&rng)); };
    const Vec3d v = at(cosine(), 6 * next_double(&rng)), l = at(cosine(), 6 * next_double(&rng));
    const float roughness = i % 5 == 0 ? 0 : next_float(&rng);
    const double r = static_cast<double>(roughness), value = sheen_value(r, kNormal, v, l);
    CHECK(sheen_value(r, kNormal, l, v) == doctest::Approx(value).epsilon(1e-9));
    const float found = sheen_value(roughness, to_float(kNormal), to_float(v), to_float(l));
    CHECK(found == doctest::Approx(value).epsilon(2e-3));
    CHECK(found * static_cast<float>(l.z) <= sheen_peak(roughness));
    CHECK(sheen_peak(roughness) <= sheen_peak(roughness / 2));
  }
  CHECK(sheen_value(0.5, kNormal, at(0.5, 0), at(-0.5, 1)) == 0);
  CHECK(sheen_value(0.5, kNormal, at(-0.3, 0), at(0.5, 1)) ==
        doctest::Approx(sheen_value(0.5, kNormal, at(0.3, 0), at(0.5, 1))));
}

// Goal: the bound rests on the table: n·v + w(n·v) is never less. Method: fine steps.
TEST_CASE("sheen_bound_holds_for_its_table") {
  for (int i = 0; i <= 100; ++i)
    for (int k = 0; k <= 2000; ++k) {
      const double root = k / 2000.0;
      CHECK(root * root + sheen_w(sheen_row(i / 100.0), root * root) >= static_cast<double>(kSheenSumMin));
    }
}
