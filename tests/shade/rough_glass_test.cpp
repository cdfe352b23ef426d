// Rough glass.
#include "shade/rough_glass.h"

#include "scene/metallic_roughness.h"
#include "sunlit_sheet.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

Material frosted(float roughness, bool thin, float ior = 1.5f) {
  Material m;
  m.brdf = kGgx, m.ior = ior, m.thin = thin;
  const float root = (ior - 1) / (ior + 1), f0 = root * root;
  set_lobes({{1, 1, 1}, {f0, f0, f0}, 1}, 0, roughness, 1, &m);
  return m;
}

// Share of a cap around −z in a GGX lobe about a direction, the viewer along it.
double cap_in_lobe(const Vec3d& d, double cap, double roughness) {
  if (roughness == 0) return d.z < -cap ? 1 : 0;
  constexpr int kSteps = 20;
  Vec3d tangent, bitangent;
  make_basis(d, &tangent, &bitangent);
  double sum = 0, weights = 0;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const double u = (i / kSteps + 0.5) / kSteps, turn = 2 * kPiD * (i % kSteps) / kSteps;
    const double slope = roughness * roughness * std::sqrt(u / (1 - u));
    const Vec3d h = normalize(d + tangent * (slope * std::cos(turn)) + bitangent * (slope * std::sin(turn)));
    const Vec3d l = h * (2 * dot(d, h)) - d;
    const double weight = std::fmax(dot(l, d), 0);
    weights += weight, sum += l.z < -cap ? weight : 0;
  }
  return sum / weights;
}

}  // namespace

// Goal: light that passes a rough pane comes from around the direction behind it, as widely as the lobe. Method: an
// environment that is bright in a cap behind the pane; the share of the cap grows with the roughness as the integral
// over facets says; a smooth pane shows the cap alone.
TEST_CASE("rough_glass_blurs_what_is_behind_it") {
  const Vec3 eye = {0.1f, 0.2f, 5};  // along the normal
  const double cap = 0.9;
  const TestEnvironment sky(128, 16, {0, 0, 0}, [&](const Vec3d& d, int level) {
    const double light = cap_in_lobe(d, cap, level < 0 ? 0 : static_cast<double>(kGlossRoughness[level]));
    return Vec3d{light, light, light};
  });
  double last = 2;
  for (float roughness : {0.2f, 0.4f, 0.6f, 0.8f}) {
    SunlitSheet s(frosted(roughness, true), false);
    sky.give(&s.scene.scene);
    s.scene.bind();
    const double found = static_cast<double>(seen(&s.scene, eye).x);
    // tan² of the facet's angle is α² u/(1 − u); the mirrored direction turns by twice the angle.
    const double alpha = static_cast<double>(roughness) * static_cast<double>(roughness), half = std::acos(cap) / 2;
    const double slope = std::tan(half) / alpha, share = slope * slope / (1 + slope * slope);
    CAPTURE(roughness);
    CAPTURE(share);
    CAPTURE(found);
    CHECK(found < last);
    CHECK(found == doctest::Approx(share * 0.92).epsilon(0.25));
    last = found;
  }
}

// Goal: rough glass neither adds light nor loses more than its facets hide. Method: uniform surroundings, panes and
// bodies, roughness from smooth to rough, views from steep to grazing.
TEST_CASE("rough_glass_keeps_energy") {
  for (bool thin : {true, false})
    for (float roughness : {0.05f, 0.3f, 0.6f, 1.0f})
      for (const Vec3& eye : {Vec3{0.4f, 0.1f, 3}, Vec3{-1, -2, 1.5f}, Vec3{4, 1, 0.8f}}) {
        SunlitSheet s(frosted(roughness, thin), false);
        if (!thin) add_sheet(&s.scene, -1, 0, true, 10);
        s.scene.scene.info.background = s.scene.scene.info.ambient = {1, 1, 1};
        const float found = seen(&s.scene, eye).x;
        CAPTURE(thin);
        CAPTURE(roughness);
        CAPTURE(eye.z);
        CHECK(found < 1.06f);
        CHECK(found > (roughness < 0.4f ? 0.65f : 0.15f));
      }
}

// Goal: smooth glass is not rough; a beam is wider after two boundaries than after one; thin sheets scatter less the
// closer their index is to 1. Method: the rules' values.
TEST_CASE("rough_glass_widens_beams") {
  CHECK_FALSE(is_rough_glass(frosted(0, false)));
  CHECK(is_rough_glass(frosted(0.2f, false)));
  const Material m = frosted(0.6f, false);
  const float once = widened_beam(m, 0.0f, 1 / 1.5f), twice = widened_beam(m, once, 1.5f);
  CHECK(once == doctest::Approx(0.36 / 6));
  CHECK(twice == doctest::Approx(std::hypot(0.36 / 4, 0.36 / 4)));
  CHECK(widened_beam(frosted(1, true), 0.9f, 1 / 1.5f) == 1);
  CHECK(facet_alpha<float>(frosted(0.6f, true, 1.25f)) == doctest::Approx(0.18));
  CHECK(facet_alpha<float>(frosted(0.6f, true, 2)) == doctest::Approx(0.36));
}

// Goal: a ray through each facet refracts by Snell's law about its normal. Method: the sines on both sides.
TEST_CASE("rough_glass_refracts_by_snells_law") {
  const Material m = frosted(0.8f, false);
  for (const Vec3d& d : {Vec3d{0, 0, -1}, Vec3d{0.6, 0.3, -0.4}})
    for (double eta : {1 / 1.5, 1.5}) {
      const Vec3d way = normalize(d), n = {0, 0, 1};
      for (double x : {-0.3, 0.0, 0.2}) {
        const Vec3d h = normalize(Vec3d{x, 0.1, 1}), passed = passed_direction(m, way, n, h, eta);
        if (is_zero(passed)) continue;
        CHECK(length(cross(passed, h)) == doctest::Approx(eta * length(cross(way, h))));
        CHECK(dot(cross(way, h), cross(passed, h)) > 0);
      }
    }
}
