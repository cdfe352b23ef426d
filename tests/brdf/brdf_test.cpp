#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/rng.h"
#include "brdf/brdf_list.h"
#include "support/effort.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

const float kExponents[] = {0, 0.5f, 1, 8, 50, 1000, 1e6f};
constexpr Vec3 kNormal = {0, 0, 1};
constexpr LobeFrame kFrame = {kNormal, {0, 0, 0}};
const LobeFrameD kExactFrame = {{0, 0, 1}, {0, 0, 0}};
constexpr Vec3 kNoDiffuse = {0, 0, 0};
constexpr double kPi = 3.14159265358979;

Material lobe(std::uint32_t brdf, float exponent) {
  Material m;
  m.brdf = brdf;
  m.exponent = exponent;
  m.roughness = std::sqrt(2 / (exponent + 2));  // as wide
  m.specular = {0.9f, 0.5f, 0.1f};
  m.grazing = 0.9f;
  return m;
}

// A lobe of the list, or its twin with a grain.
struct Lobe {
  std::uint32_t brdf;
  const BrdfInfo* info;
  Vec3 grain;

  LobeFrame frame() const { return {kNormal, grain}; }
  LobeFrameD exact_frame() const { return {to_double(kNormal), to_double(grain)}; }
};
std::vector<Lobe> all_lobes() {
  std::vector<Lobe> lobes;
  for (std::uint32_t b = 0; b < kBrdfCount; ++b) {
    lobes.push_back({b, kBrdfList[b], {0, 0, 0}});
    if (!kBrdfList[b]->with_grain) continue;
    for (const Vec3& grain : {Vec3{0, 0, 0}, Vec3{0.4f, 0.3f, 0}, Vec3{0, 0.9f, 0}, Vec3{1, 0, 0}})
      lobes.push_back({b, kBrdfList[b]->with_grain, grain});
  }
  return lobes;
}
// Finer than the grid of reflected_share(), or too much for an emulated CPU.
bool is_skipped(const Lobe& l, float exponent) {
  return (!is_zero(l.grain) && exponent > 50) || (kEffortDivisor > 1 && l.info != kBrdfList[l.brdf] && exponent != 8);
}
#define CAPTURE_LOBE(l)               \
  CAPTURE(std::string(l.info->name)); \
  CAPTURE(length(l.grain))

Vec3 upward(Rng* rng) {
  for (;;) {
    Vec3 d = {2 * next_float(rng) - 1, 2 * next_float(rng) - 1, next_float(rng)};
    if (dot(d, d) <= 1 && d.z > 0.01f) return normalize(d);
  }
}

// The direction of the lobe's peak: a sample of the sharpest lobe.
Vec3 axis_of(std::uint32_t brdf, const Vec3& to_viewer) {
  Vec3d axis = kBrdfList[brdf]->sample(lobe(brdf, 1e9f), kExactFrame, normalize(to_double(to_viewer)), 0, 0.5);
  return {static_cast<float>(axis.x), static_cast<float>(axis.y), static_cast<float>(axis.z)};
}

// ∫ f cosθ dω over the hemisphere, by a polar grid around the lobe's axis that gets finer towards it.
double reflected_share(const Material& m, const Vec3& to_viewer, const BrdfInfo& brdf, const LobeFrame& frame) {
  Vec3 axis = axis_of(m.brdf, to_viewer), s, t;
  make_basis(axis, &s, &t);
  constexpr int kPolar = kEffortDivisor > 1 ? 300 : 600;
  const int around_count = is_zero(frame.grain) || kEffortDivisor > 1 ? 48 : 240;  // a ridge
  double sum = 0;
  for (int i = 0; i < kPolar; ++i) {
    double x0 = double(i) / kPolar, x1 = double(i + 1) / kPolar, x = (x0 + x1) / 2;
    double angle = kPi * std::pow(x, 4), width = kPi * (std::pow(x1, 4) - std::pow(x0, 4));
    for (int j = 0; j < around_count; ++j) {
      double around = 2 * kPi * (j + 0.5) / around_count;
      Vec3 l = normalize(axis * float(std::cos(angle)) + s * float(std::sin(angle) * std::cos(around)) +
                         t * float(std::sin(angle) * std::sin(around)));
      if (l.z <= 0) continue;
      sum += double(brdf.value(m, m.specular, kNoDiffuse, frame, to_viewer, l).x) * l.z * std::sin(angle) * width *
             (2 * kPi / around_count);
    }
  }
  return sum;
}
double reflected_share(const Material& m, const Vec3& to_viewer) {
  return reflected_share(m, to_viewer, *kBrdfList[m.brdf], kFrame);
}

}  // namespace

// Goal: light paths are reversible [Helmholtz]. Method: invariant over random pairs of directions, for every lobe
// listed.
TEST_CASE("brdf_is_reciprocal") {
  for (const Lobe& tested : all_lobes())
    for (float exponent : kExponents) {
      const std::uint32_t b = tested.brdf;
      Material m = lobe(b, exponent);
      Rng rng = make_rng(b + 1);
      CAPTURE_LOBE(tested);
      CAPTURE(exponent);
      float worst = 0;
      for (int i = 0; i < 2000; ++i) {
        Vec3 v = upward(&rng), l = upward(&rng);
        if (i % 2) l = normalize(axis_of(b, v) + l * 0.01f);
        float there = tested.info->value(m, m.specular, kNoDiffuse, tested.frame(), v, l).x,
              back = tested.info->value(m, m.specular, kNoDiffuse, tested.frame(), l, v).x;
        worst = std::max(worst, std::fabs(there - back) / (there + back + 1e-20f));
      }
      CHECK(worst <= 2e-7f);
    }
}

// Goal: a lobe reflects no more than its albedo. Method: quadrature of the albedo over viewing angles, for every lobe
// listed; at normal incidence the Phong lobe reflects all of it.
TEST_CASE("brdf_conserves_energy") {
  for (const Lobe& tested : all_lobes())
    for (float exponent : kExponents)
      for (double degrees : {0.0, 20.0, 45.0, 70.0, 85.0, 89.0}) {
        if (is_skipped(tested, exponent)) continue;
        Material m = lobe(tested.brdf, exponent);
        Vec3 v = {float(std::sin(degrees * kPi / 180)), 0, float(std::cos(degrees * kPi / 180))};
        double share = reflected_share(m, v, *tested.info, tested.frame());
        CAPTURE_LOBE(tested);
        CAPTURE(exponent);
        CAPTURE(degrees);
        CAPTURE(share);
        // Direction cosines err by 1e-7, which a power of n magnifies n times. What scatters more than once is taken as
        // without a grain.
        CHECK(share <= 0.9 * ((is_zero(tested.grain) ? 1.002 : 1.01) + double(exponent) * 1e-7));
        CHECK(share > 0);
        if (degrees == 0 && tested.brdf == kPhong)
          CHECK(share == doctest::Approx(0.9).epsilon(0.002 + double(exponent) * 1e-7));
      }
}

// Goal: no value × cosine exceeds the peak that the cut-off relies on or is negative or NaN, for exponents from 0 to
// 10⁶ (HARDCASES row 31). Method: sampling around the lobe's axis and elsewhere, at grazing angles, and with vectors
// slightly longer than unit.
TEST_CASE("hard_31_brdf_is_finite_and_below_its_peak") {
  count_assertions("finite, at most the peak");
  for (const Lobe& tested : all_lobes())
    for (float exponent : kExponents) {
      const std::uint32_t b = tested.brdf;
      Material m = lobe(b, exponent);
      Vec3 peak = tested.info->peak(m);
      const LobeFrame frame = tested.frame();
      CAPTURE_LOBE(tested);
      CAPTURE(exponent);
      REQUIRE(is_finite(peak));
      Rng rng = make_rng(17);
      float most = 0;
      bool bounded = true;
      for (int i = 0; i < 5000; ++i) {
        Vec3 v = upward(&rng), l = i % 2 ? axis_of(b, v) : upward(&rng);
        if (i % 8 == 2) v = {1, 0, 1e-7f}, l = {-1, 0, std::pow(10.0f, -6 * next_float(&rng))}, l = normalize(l);
        if (i % 4 == 3) v = v * 1.0000002f, l = l * 1.0000002f;  // HARDCASES row 30: n·n slightly above 1
        if (i % 8 == 4) v = l = kNormal;
        if (i % 16 == 13) v.z = -0.5f * v.z;  // below the horizon of an interpolated normal
        if (i % 16 == 5) v = {std::sqrt(1 - 0.0025f), 0, 0.05f}, l = {-v.x, 0, 0.05f};
        Vec3 f = tested.info->value(m, m.specular, kNoDiffuse, frame, v, l) * l.z;
        Vec3 above = tested.info->value(m, {0, 0, 0}, {1, 1, 1}, frame, v, l);
        m.grazing = 0;
        Vec3 below = tested.info->value(m, {0, 0, 0}, {1, 1, 1}, frame, v, l);
        m.grazing = 0.9f;
        bounded &= below.x >= 0 && below.x <= tested.info->diffuse_max && above.x >= below.x;
        bounded &= f.x >= 0 && f.x <= peak.x && f.y <= peak.y && f.z <= peak.z;
        most = std::max(most, f.x);
      }
      CHECK(bounded);
      // And the bound is tight, without a grain: Ward's within 2.3; with one to come, GGX scatters more again.
      const bool is_even = tested.info == kBrdfList[b];
      if (is_zero(tested.grain)) CHECK(most >= (b == kWard ? 0.45f : is_even ? 0.6f : 0.55f) * peak.x);
    }
}

// Goal: the reference has the same lobes. Method: the value in double precision against the float value, for random
// directions and near the axis, for every lobe listed, times the light's cosine as in the peak. A float cosine errs by
// 1e-7, magnified by powers of n.
TEST_CASE("brdf_exact_value_is_the_value") {
  for (const Lobe& tested : all_lobes())
    for (float exponent : kExponents) {
      if (exponent > 1000) continue;
      const std::uint32_t b = tested.brdf;
      Material m = lobe(b, exponent);
      Rng rng = make_rng(b + 23);
      CAPTURE_LOBE(tested);
      CAPTURE(exponent);
      double worst = 0, peak = static_cast<double>(tested.info->peak(m).x);
      for (int i = 0; i < 2000; ++i) {
        Vec3 v = upward(&rng), l = upward(&rng);
        if (i % 2) l = normalize(axis_of(b, v) + l * 0.01f);
        double value = static_cast<double>(tested.info->value(m, m.specular, kNoDiffuse, tested.frame(), v, l).x);
        double exact = tested.info
                           ->exact_value(m, to_double(m.specular), {0, 0, 0}, tested.exact_frame(),
                                         normalize(to_double(v)), normalize(to_double(l)))
                           .x;
        worst = std::max(worst, std::fabs(value - exact) * static_cast<double>(l.z) / peak);
      }
      CHECK(worst <= 1e-6 + static_cast<double>(exponent) * 4e-7);
    }
}

// Goal: samples have the stated density, so that their mean is an integral. Method: the albedo as the mean of value ·
// cosine / density over random directions from sample(), against its quadrature, within the standard error. For every
// lobe listed.
TEST_CASE("brdf_samples_integrate_to_the_albedo") {
  constexpr int kSamples = effort(40000);
  for (const Lobe& tested : all_lobes())
    for (float exponent : {0.0f, 1.0f, 8.0f, 50.0f, 1000.0f})
      for (double degrees : {0.0, 45.0, 80.0}) {
        if (is_skipped(tested, exponent)) continue;
        const std::uint32_t b = tested.brdf;
        Material m = lobe(b, exponent);
        const BrdfInfo& brdf = *tested.info;
        Vec3 v = {float(std::sin(degrees * kPi / 180)), 0, float(std::cos(degrees * kPi / 180))};
        const LobeFrameD frame = tested.exact_frame();
        Vec3d to_viewer = normalize(to_double(v));
        Rng rng = make_rng(b + 29);
        double sum = 0, squares = 0;
        for (int i = 0; i < kSamples; ++i) {
          double u = next_double(&rng);
          Vec3d l = brdf.sample(m, frame, to_viewer, u, next_double(&rng));
          if (!(l.z > 0)) continue;
          double x = brdf.exact_value(m, to_double(m.specular), {0, 0, 0}, frame, to_viewer, l).x * l.z /
                     brdf.density(m, frame, to_viewer, l);
          sum += x, squares += x * x;
        }
        double mean = sum / kSamples, error = std::sqrt((squares / kSamples - mean * mean) / kSamples);
        CAPTURE_LOBE(tested);
        CAPTURE(exponent);
        CAPTURE(degrees);
        CHECK(std::fabs(mean - reflected_share(m, v, brdf, tested.frame())) <= 4 * error + 0.003);
      }
}

// Goal: the GGX lobe is the one of glTF 2.0, appendix B, for light scattered once. Method: its formulas as printed
// there, evaluated in double precision, at random directions. The colour of the light scattered more often has the mean
// of Schlick's term as a factor: it is 0 where grazing is −20 times the specular reflectance.
TEST_CASE("ggx_has_the_value_of_its_closed_form") {
  Rng rng = make_rng(5);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    Material m = lobe(kGgx, 1);
    m.roughness = 0.05f + 0.95f * next_float(&rng);
    m.specular = Vec3{1, 1, 1} * next_float(&rng), m.grazing = -20 * m.specular.x;
    Vec3d v = normalize(to_double(upward(&rng))), l = normalize(to_double(upward(&rng))), h = normalize(v + l);
    double a2 = double(m.roughness) * double(m.roughness), cos_half = dot(v, h);
    double d = a2 / (kPi * std::pow(h.z * h.z * (a2 - 1) + 1, 2));
    double masking = 0.5 / (l.z * std::sqrt(v.z * v.z * (1 - a2) + a2) + v.z * std::sqrt(l.z * l.z * (1 - a2) + a2));
    Vec3d f = kBrdfList[kGgx]->exact_value(m, to_double(m.specular), {0, 0, 0}, kExactFrame, v, l);
    for (int c = 0; c < 3; ++c) {
      double f0 = static_cast<double>(m.specular[c]), fresnel = f0 - 21 * f0 * std::pow(1 - cos_half, 5);
      worst = std::max(worst, std::fabs(f[c] - d * masking * fresnel) / (d * masking));
    }
  }
  CHECK(worst < 1e-6);  // grazing is rounded to a float
}

// Goal: the GGX lobe with a grain is that of KHR_materials_anisotropy, for light scattered once; without one, it is the
// plain lobe. Method: the extension's formulas as printed, in double precision, at random directions and grains.
TEST_CASE("ggx_with_grain_has_the_value_of_its_closed_form") {
  const BrdfInfo& grained = *kBrdfList[kGgx]->with_grain;
  Rng rng = make_rng(6);
  double worst = 0, plain = 0;
  for (int i = 0; i < 3000; ++i) {
    Material m = lobe(kGgx, 1);
    m.roughness = 0.05f + 0.95f * next_float(&rng);
    m.specular = Vec3{1, 1, 1} * next_float(&rng), m.grazing = -20 * m.specular.x;
    const double turn = 2 * kPi * next_double(&rng), strength = i % 3 ? next_double(&rng) : 0;
    const Vec3d t = {std::cos(turn), std::sin(turn), 0}, b = {-t.y, t.x, 0};
    const Vec3d v = normalize(to_double(upward(&rng))), l = normalize(to_double(upward(&rng))), h = normalize(v + l);
    const double alpha = double(m.roughness), at = alpha + (1 - alpha) * strength * strength, ab = alpha;
    const double a2 = at * ab, x = ab * dot(t, h), y = at * dot(b, h), z = a2 * h.z;
    const double w2 = a2 / (x * x + y * y + z * z), d = a2 * w2 * w2 / kPi;
    auto root = [&](const Vec3d& way) {
      return std::sqrt(std::pow(at * dot(t, way), 2) + std::pow(ab * dot(b, way), 2) + way.z * way.z);
    };
    const double masking = 0.5 / (l.z * root(v) + v.z * root(l)), f0 = double(m.specular.x);
    const double expected = d * masking * (f0 - 21 * f0 * std::pow(1 - dot(v, h), 5));
    const LobeFrameD frame = {{0, 0, 1}, t * strength};
    const double found = grained.exact_value(m, to_double(m.specular), {0, 0, 0}, frame, v, l).x;
    worst = std::max(worst, std::fabs(found - expected) / (d * masking));
    if (strength > 0) continue;
    const double even = kBrdfList[kGgx]->exact_value(m, to_double(m.specular), {0, 0, 0}, frame, v, l).x;
    plain = std::max(plain, std::fabs(found - even) / (d * masking));
  }
  CHECK(worst < 2e-6);  // grazing is rounded to a float
  CHECK(plain < 1e-9);
}

// Goal: Ward's lobe has the value and width that [Ward 1992, eq. 5b] states. Method: at normal incidence, where the
// form with bounded albedo agrees: specular/(4π αx αy), falling by e at slopes αx along the grain and αy across.
TEST_CASE("ward_has_its_peak_and_widths") {
  Material m = lobe(kWard, 50);
  const double across = double(m.roughness), along = across + (1 - across) * 0.25;
  const LobeFrameD frame = {{0, 0, 1}, {0, 0.5, 0}};
  const BrdfInfo& ward = *kBrdfList[kWard]->with_grain;
  auto at = [&](const Vec3d& half) {  // h·h/(h·n)⁴ is 4/16 for v = l = n, and (1 + slope²)/(h·n)² elsewhere
    const Vec3d h = normalize(half);
    const double rise = 2 * h.z;
    return ward.exact_value(m, {1, 1, 1}, {0, 0, 0}, frame, h, h).x * rise * rise * h.z * h.z;
  };
  const double peak = at({0, 0, 1}) / 4;
  CHECK(peak == doctest::Approx(1 / (4 * kPi * along * across)).epsilon(1e-9));
  CHECK(at({across, 0, 1}) / 4 == doctest::Approx(peak / std::exp(1.0)).epsilon(1e-9));
  CHECK(at({0, along, 1}) / 4 == doctest::Approx(peak / std::exp(1.0)).epsilon(1e-9));
}

// Goal: a white rough metal in a white furnace reflects all light, once or more often scattered, and a coloured one the
// share of its colour at each scattering. Method: quadrature; closed form for α = 1 and F = c, from the energy of the
// lobe E = 1 − μ ln(1 + 1/μ), whose mean over the hemisphere is Ē: c E + (1 − E) c² Ē / (1 − c (1 − Ē)).
TEST_CASE("ggx_in_a_white_furnace") {
  Material m = lobe(kGgx, 0);
  for (float alpha : {0.1f, 0.3f, 0.6f, 1.0f})
    for (double cosine : {1.0, 0.7, 0.3, 0.05}) {
      m.roughness = alpha, m.grazing = 1, m.specular = {1, 1, 1};
      CAPTURE(alpha);
      CAPTURE(cosine);
      const Vec3 v = {float(std::sqrt(1 - cosine * cosine)), 0, float(cosine)};
      CHECK(reflected_share(m, v) == doctest::Approx(1).epsilon(0.008));
    }
  double mean = 0;  // of E
  for (int i = 0; i < 100000; ++i) {
    const double mu = (i + 0.5) / 100000;
    mean += (1 - mu * std::log(1 + 1 / mu)) * 2 * mu / 100000;
  }
  for (float color : {0.2f, 0.5f, 0.9f}) {
    m.roughness = 1, m.grazing = color, m.specular = {color, color, color};
    for (double cosine : {1.0, 0.5, 0.1}) {
      const double energy = 1 - cosine * std::log(1 + 1 / cosine), c = double(color);
      const Vec3 v = {float(std::sqrt(1 - cosine * cosine)), 0, float(cosine)};
      CAPTURE(color);
      CAPTURE(cosine);
      const double expected = c * energy + (1 - energy) * c * c * mean / (1 - c * (1 - mean));
      CHECK(reflected_share(m, v) == doctest::Approx(expected).epsilon(0.01));
      const BrdfAlbedo albedo = kBrdfList[kGgx]->albedo(m, m.specular, float(cosine));
      CHECK(double(albedo.once.x + albedo.scattered.x) == doctest::Approx(expected).epsilon(0.02));
    }
  }
}

// Goal: a GGX lobe of α = 0 and viewers on or below the horizon of an interpolated normal give finite values, samples
// and densities, and the value does not jump there (HARDCASES row 30). Method: sweep through the horizon.
TEST_CASE("hard_30_ggx_is_finite_at_roughness_zero_and_below_the_horizon") {
  count_assertions("finite, and continuous across the horizon");
  const BrdfInfo& ggx = *kBrdfList[kGgx];
  for (float alpha : {0.0f, 1e-20f, 0.01f, 0.5f, 1.0f}) {
    Material m = lobe(kGgx, 0);
    m.roughness = alpha;
    CAPTURE(alpha);
    for (float height : {-1.0f, -0.1f, -1e-3f, -1e-30f, 0.0f, 1e-38f, 1e-18f, 1e-10f, 1e-3f, 1.0f}) {
      CAPTURE(height);
      Vec3 v = normalize(Vec3{1, 0, height});
      for (Vec3 l :
           {Vec3{-1, 0, 1e-38f}, Vec3{-1, 0, 1e-18f}, Vec3{-1, 0, 1e-4f}, Vec3{0, 0, 1}, Vec3{0, 0, -1}, -v, v}) {
        Vec3 f = ggx.value(m, m.specular, kNoDiffuse, kFrame, v, l);
        CHECK((is_finite(f * kRadianceMax) && f.x >= 0 && (l.z > 0 || is_zero(f))));
      }
      for (double u : {0.0, 0.5, 1 - 0x1p-53}) {
        Vec3d l = ggx.sample(m, kExactFrame, normalize(to_double(v)), u, u);
        double density = ggx.density(m, kExactFrame, normalize(to_double(v)), l);
        CHECK((is_finite(l) && std::fabs(length(l) - 1) < 1e-9 && std::isfinite(density) && density >= 0));
      }
    }
    Vec3 l = normalize(Vec3{-1, 0.2f, 0.5f});
    float above = ggx.value(m, m.specular, kNoDiffuse, kFrame, normalize(Vec3{1, 0, 1e-4f}), l).x,
          below = ggx.value(m, m.specular, kNoDiffuse, kFrame, normalize(Vec3{1, 0, -1e-4f}), l).x;
    CHECK(above == below);
  }
}

// Goal: a white plastic reflects no more light than it receives. Method: quadrature of the diffuse lobe and the GGX
// lobe above it, over roughness and viewing angle; Lambertian of albedo 1, F₀ = .04 to 1.
TEST_CASE("ggx_over_white_conserves_energy") {
  constexpr int kRings = effort_side(300);
  for (double alpha : {0.1, 0.3, 0.6, 1.0})
    for (double degrees : {0.0, 30.0, 60.0, 80.0}) {
      Material m;
      m.brdf = kGgx, m.roughness = float(alpha), m.specular = {0.04f, 0.04f, 0.04f}, m.grazing = 1;
      Vec3d v = {std::sin(degrees * kPi / 180), 0, std::cos(degrees * kPi / 180)}, white = Vec3d{1, 1, 1} * (1 / kPi);
      double sum = 0;
      for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < kRings; ++j) {
          double cosine = std::sqrt((i + 0.5) / kRings), sine = std::sqrt(1 - cosine * cosine);
          double turn = 2 * kPi * (j + 0.5) / kRings;
          Vec3d l = {sine * std::cos(turn), sine * std::sin(turn), cosine};
          sum += kBrdfList[kGgx]->exact_value(m, to_double(m.specular), white, kExactFrame, v, l).x * kPi;
        }
      double share = sum / (kRings * kRings);
      CAPTURE(alpha);
      CAPTURE(degrees);
      CHECK(share <= 1.002);
      if (degrees == 0) CHECK(share > 0.96 + 0.04 * 0.3);
    }
}

// Goal: the table of the share of uniform light that the lobe reflects is that share. Method: the mean of value ×
// cosine / density over even samples, for F = 1 and for the rise alone, between the table's points.
TEST_CASE("ggx_reflects_the_integral_of_its_value") {
  constexpr int kSide = 60, kSteps = effort_side(15);
  const BrdfInfo& ggx = *kBrdfList[kGgx];
  double worst = 0, squares = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j)
      for (float specular : {0.0f, 1.0f}) {
        Material m;
        float roughness = 0.1f + 0.9f * float(i + 0.5) / kSteps;
        m.brdf = kGgx, m.roughness = roughness * roughness, m.grazing = 1, m.specular = {specular, specular, specular};
        double cosine = std::pow((j + 0.5) / kSteps, 2), sum = 0;
        Vec3d v = {std::sqrt(1 - cosine * cosine), 0, cosine};
        for (int k = 0; k < kSide * kSide; ++k) {
          const double first = 0.7548776662466927 * k,
                       second = 0.5698402909980532 * k;  // even in any part of the square
          Vec3d l = ggx.sample(m, kExactFrame, v, first - std::floor(first), second - std::floor(second));
          if (l.z > 0)
            sum += ggx.exact_value(m, to_double(m.specular), {0, 0, 0}, kExactFrame, v, l).x * l.z /
                   ggx.density(m, kExactFrame, v, l);
        }
        const BrdfAlbedo albedo = ggx.albedo(m, m.specular, float(cosine));
        double off = double(albedo.once.x + albedo.scattered.x) - sum / (kSide * kSide);
        worst = std::max(worst, std::fabs(off)), squares += off * off;
      }
  CHECK(worst < 0.035);
  CHECK(std::sqrt(squares / (2 * kSteps * kSteps)) < 0.005);
  Material m = lobe(kGgx, 1);
  for (float alpha : {0.0f, 1e-9f, 1.0f})
    for (float cosine : {-1.0f, 0.0f, 1e-30f, 1.0f, 1.0000002f}) {
      m.roughness = alpha;
      const BrdfAlbedo albedo = ggx.albedo(m, m.specular, cosine);
      Vec3 share = albedo.once + albedo.scattered;
      CHECK((is_finite(share) && share.x >= 0 && share.x <= 0.9f && share.z <= share.y));
    }
}

// Goal: names are unique, and the order of the list, part of the file format, begins with Phong.
TEST_CASE("brdf_list_begins_with_phong") {
  CHECK(std::string(kBrdfList[0]->name) == "phong");
  for (std::uint32_t i = 0; i < kBrdfCount; ++i)
    for (std::uint32_t j = 0; j < i; ++j) CHECK(std::string(kBrdfList[i]->name) != kBrdfList[j]->name);
}
