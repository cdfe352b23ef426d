// The reference under environments.
#include "desktop/reference/environment.h"

#include <doctest/doctest.h>

#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "desktop/reference/rendered.h"
#include "reference/reference_helpers.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

// Soft light with a bright spot of about 10°.
Vec3d spotted(const Vec3d& d) {
  const double at_spot = dot(d, normalize(Vec3d{1, 2, 1}));
  return Vec3d{0.3, 0.4, 0.5} * (1 + d.y) + Vec3d{1, 1, 1} * (at_spot > 0.985 ? 40.0 : 0.0);
}
TestEnvironment spotted_environment() {
  return TestEnvironment(32, 4, {1, 1, 1}, [](const Vec3d& d, int) { return spotted(d); });
}

Material shiny(float alpha, float diffuse) {
  Material m;
  m.diffuse = {diffuse, diffuse, diffuse}, m.specular = {0.8f, 0.8f, 0.8f};
  m.brdf = kGgx, m.roughness = alpha, m.grazing = 1;
  return m;
}

void add_floor(GeneratedScene* s, const Material& m) {
  add_quad(s, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, add_material(s, m));
  aim(s, {0, 2, 2}, {0, 0, 0}, 40);
  s->bind();
}

}  // namespace

// Goal: directions are picked with the density stated. Method: the mean of f / density over picked directions is ∫ f,
// for f = 1 where the environment shines and for the environment itself; the density integrates to 1.
TEST_CASE("environment_reference_picks_directions_with_its_density") {
  const TestEnvironment environment = spotted_environment();
  GeneratedScene s;
  add_floor(&s, shiny(0.5f, 0.2f));
  environment.give(&s.scene);
  const TestReference t(s.scene);
  Rng rng = make_rng(5);
  double ones = 0, light = 0, squares = 0;
  constexpr int kCount = 40000;
  for (int i = 0; i < kCount; ++i) {
    const double u = next_double(&rng), v = next_double(&rng);
    const Vec3d d = sample_environment(t.reference, {u, v});
    const double density = environment_density(t.reference, d);
    const double value = radiance_behind(t.renderer->renderer.frame, d).y / density;
    REQUIRE(density > 0);
    ones += 1 / density, light += value, squares += value * value;
  }
  CHECK(ones / kCount == doctest::Approx(4 * kPi).epsilon(0.05));
  double integral = 0, density = 0;
  constexpr int kSide = 512;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec3d p = from_octahedral(2 * (i % kSide + 0.5) / kSide - 1, 2 * (i / kSide + 0.5) / kSide - 1);
    const double solid_angle = 4.0 / (kSide * kSide) / std::pow(dot(p, p), 1.5);
    integral += radiance_behind(t.renderer->renderer.frame, normalize(p)).y * solid_angle;
    density += environment_density(t.reference, normalize(p)) * solid_angle;
  }
  CHECK(density == doctest::Approx(1).epsilon(1e-3));
  const double mean = light / kCount, spread = std::sqrt(squares / kCount - mean * mean);
  CHECK(mean == doctest::Approx(integral).epsilon(0.01));
  CHECK(spread < 0.5 * mean);  // importance: even directions would spread by several times the mean
}

// Goal: both kinds of reference take the light of the environment on a floor: its integral with the lobes. Method:
// numeric integration in directions, diffuse and GGX of several roughnesses; the floor alone casts no shadow, so that
// the two differ only in what the lobe leaves of diffuse light.
TEST_CASE("environment_reference_is_the_integral_over_directions") {
  const TestEnvironment environment = spotted_environment();
  const Vec3d way = normalize(Vec3d{0, -1, -1}), n = {0, 1, 0};
  for (float alpha : {0.05f, 0.2f, 0.6f, 1.0f})
    for (float diffuse : {0.0f, 0.5f}) {
      GeneratedScene s;
      const Material m = shiny(alpha, diffuse);
      add_floor(&s, m);
      environment.give(&s.scene);
      const TestReference t(s.scene);
      double physical = 0, model = 0;
      constexpr int kSide = 1024;
      for (int i = 0; i < kSide * kSide; ++i) {
        const Vec3d p = from_octahedral(2 * (i % kSide + 0.5) / kSide - 1, 2 * (i / kSide + 0.5) / kSide - 1);
        const Vec3d d = normalize(p);
        if (!(d.y > 0)) continue;
        const double light =
            radiance_behind(t.renderer->renderer.frame, d).y * d.y * 4.0 / (kSide * kSide) / std::pow(dot(p, p), 1.5);
        const Vec3d lambert = Vec3d{1, 1, 1} * (double(diffuse) / kPi), specular = to_double(m.specular);
        physical += light * kGgxBrdf.exact_value(m, specular, lambert, {n, {0, 0, 0}}, -way, d).y;
        model += light * (kGgxBrdf.exact_value(m, specular, {0, 0, 0}, {n, {0, 0, 0}}, -way, d).y + lambert.y);
      }
      CAPTURE(alpha);
      CAPTURE(diffuse);
      check_equal(estimate(t, Transport::physical, {0, 2, 2}, way, 20000), physical, 2e-3);
      check_equal(estimate(t, Transport::model, {0, 2, 2}, way, 20000), model, 2e-3);
    }
}

// Goal: the sun that the map shows lights a floor once: as a directional light for the renderer and its model, from the
// map in full transport. Method: the integral of the map over the hemisphere; a light that has what exceeds the sun's
// surroundings.
TEST_CASE("environment_sun_lights_once") {
  const Vec3d middle = normalize(Vec3d{1, 2, 1});
  auto map = [&](const Vec3d& d) {
    const double light = dot(d, middle) > det_cos(radians(3)) ? 800.0 : 1.0;
    return Vec3d{light, light, light};
  };
  const TestEnvironment environment(128, 4, {1, 1, 1}, [&](const Vec3d& d, int level) {
    return level < 0 ? map(d) : Vec3d{1, 1, 1};
  });
  double sun_only = 0;
  for (int i = 0; i < 128 * 128; ++i) {
    const Vec3d p = from_octahedral(2 * (i % 128 + 0.5) / 128 - 1, 2 * (i / 128 + 0.5) / 128 - 1);
    sun_only += (map(normalize(p)).y - 1) * 4.0 / (128 * 128) / std::pow(dot(p, p), 1.5);
  }
  GeneratedScene s;
  add_floor(&s, white());
  Light light;
  light.kind = LightKind::directional, light.direction = to_float(-middle);
  light.intensity = Vec3{1, 1, 1} * static_cast<float>(sun_only);
  s.lights = {light};
  s.bind();
  environment.give(&s.scene);
  const EnvironmentSun sun = {0, static_cast<float>(radians(3)), static_cast<float>(det_cos(radians(5))), 1};
  s.scene.environment_suns = {&sun, 1};
  const double expected = 1 + sun_only * middle.y / kPi;
  CHECK(expected > 1.5);
  for (std::uint32_t points : {1u, 8u}) {
    Settings settings = small_settings();
    settings.points_per_area_light = points;
    const TestReference t(s.scene, settings);
    const Vec3d way = normalize(Vec3d{0, -1, -1});
    check_equal(estimate(t, Transport::physical, {0, 2, 2}, way, 40000), expected, 0.01);
    check_equal(estimate(t, Transport::model, {0, 2, 2}, way, 40000), expected, 0.01);
    CHECK(t.renderer->renderer.image[36].y == doctest::Approx(expected).epsilon(0.01));
    CHECK(t.renderer->renderer.frame.lights.points.count == points);
  }
}

// Goal: what stands between a surface and the environment shades it, in the renderer's model where shadows from the
// environment are simulated. Method: a black lid above the floor; only light from beside it arrives.
TEST_CASE("environment_reference_casts_shadows") {
  const TestEnvironment even = even_environment({1, 1, 1});
  Material white;
  white.diffuse = {1, 1, 1};
  GeneratedScene s;
  Material black;
  black.diffuse = {0, 0, 0};
  const std::uint32_t lid = add_material(&s, black);
  add_quad(&s, {-1, 1, 1}, {-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, lid);
  add_floor(&s, white);
  even.give(&s.scene);
  const TestReference t(s.scene);
  const Vec3d way = normalize(Vec3d{0, -0.2, -1});
  // The lid is four unit squares at distance 1, each with the form factor .1385316 to a point below its corner.
  check_equal(estimate(t, Transport::physical, Vec3d{0, 0, 0} - way * 2.0, way, 40000), 1 - 4 * 0.1385316, 1e-3);
  check_equal(estimate(t, Transport::model, Vec3d{0, 0, 0} - way * 2.0, way, 40000), 1 - 4 * 0.1385316, 1e-3);
  Settings open = small_settings();
  open.environment_shadows = 0;
  const TestReference unshadowed(s.scene, open);
  check_equal(estimate(unshadowed, Transport::model, Vec3d{0, 0, 0} - way * 2.0, way, 40000), 1, 1e-3);
}

// Goal: white furnace: in an even environment an object that reflects everything cannot be seen. Method: a white
// diffuse box and a perfect mirror, all bounces.
TEST_CASE("environment_reference_hides_white_objects") {
  const TestEnvironment even = even_environment({1, 1, 1});
  Material white, mirror;
  white.diffuse = {1, 1, 1};
  mirror.diffuse = {0, 0, 0}, mirror.mirror = {1, 1, 1};
  for (const Material& m : {white, mirror}) {
    GeneratedScene s;
    add_box(&s, {-1, -1, -1}, {1, 1, 1}, add_material(&s, m));
    aim(&s, {3, 2, 4}, {0, 0, 0}, 40);
    s.bind();
    even.give(&s.scene);
    const TestReference t(s.scene);
    check_equal(estimate(t, Transport::physical, {3, 2, 4}, normalize(Vec3d{-3, -2, -4}), 4000), 1, 1e-3);
  }
}

// Goal: the renderer agrees with its model in double precision on spheres of several roughnesses under soft light: the
// split sum and nine coefficients err by 10 % of the mean at most, 4 % in the mean. Method: levels prefiltered by
// integration in the test; a picture of each sphere.
TEST_CASE("environment_renderer_agrees_with_the_reference_on_spheres") {
  auto soft = [](const Vec3d& d) { return Vec3d{1 + 0.6 * d.x, 1 + 0.5 * d.y, 1 + 0.4 * d.z}; };
  // A linear function's mean over the lobe about an axis is linear, with the lobe's mean cosine as a factor.
  auto mean_cosine = [](double alpha) {
    double sum = 0, weights = 0;
    for (int i = 0; i < 4000; ++i) {
      const double c = (i + 0.5) / 4000, term = (1 + c) / 2 * (alpha * alpha - 1) + 1, weight = c / (term * term);
      sum += weight * c, weights += weight;
    }
    return sum / weights;
  };
  TestEnvironment environment(64, 32, {1, 1, 1}, [&](const Vec3d& d, int level) {
    if (level < 0) return soft(d);
    const double r = static_cast<double>(kGlossRoughness[level]);
    return soft(d * mean_cosine(r * r));
  });
  // Irradiance / π of a linear function: two thirds of its slope.
  environment.info.irradiance[1] = {0.4f, 0, 0}, environment.info.irradiance[2] = {0, 0.5f * 2 / 3, 0};
  environment.info.irradiance[3] = {0, 0, 0.4f * 2 / 3};
  for (float alpha : {0.02f, 0.1f, 0.3f, 0.6f, 1.0f})
    for (float diffuse : {0.0f, 0.6f}) {
      GeneratedScene s;
      s.with_normals = true;
      add_sphere(&s, {0, 0, 0}, 1, 24, 12, add_material(&s, shiny(alpha, diffuse)));
      aim(&s, {0, 0, 5}, {0, 0, 0}, 26);
      s.bind();
      environment.give(&s.scene);
      Settings settings;
      settings.width = settings.height = 10, settings.cut_off_levels = 0;
      const TestReference t(s.scene, settings, 0);
      ReferenceOptions options;
      options.transport = Transport::model, options.samples_per_pixel = 256;
      std::vector<Vec3d> exact(100), rendered(100);
      trace_reference(t.reference, options, 0, 10, exact.data());
      trace_as_rendered(t.reference, 0, 10, rendered.data());
      double off = 0, worst = 0;
      int count = 0;
      for (int y = 2; y < 8; ++y)
        for (int x = 2; x < 8; ++x) {
          const auto i = static_cast<std::uint32_t>(y * 10 + x);
          const Vec3d here = to_double(t.renderer->renderer.image[i]);
          for (int c = 0; c < 3; ++c) {
            CHECK(here[c] == doctest::Approx(rendered[i][c]).epsilon(2e-3));
            off += std::fabs(here[c] - exact[i][c]), worst = std::fmax(worst, std::fabs(here[c] - exact[i][c])),
                                                     ++count;
          }
        }
      CAPTURE(alpha);
      CAPTURE(diffuse);
      CHECK(worst < 0.15);
      CHECK(off / count < 0.04);
    }
}
