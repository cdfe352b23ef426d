#include <doctest/doctest.h>

#include "base/color.h"
#include "shade/dielectric.h"
#include "shade/media.h"
#include "shade/shade_helpers.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

double reflectance(double degrees, double eta) {
  float cos_t;
  return fresnel(static_cast<float>(std::cos(degrees * kPiD / 180)), static_cast<float>(eta), &cos_t);
}

}  // namespace

// Goal: total internal reflection begins at the critical angle, without values above 1 or NaN around it. Method: sweep
// of ±2e-7 rad and beyond around asin(1/1.5).
TEST_CASE("hard_32_fresnel_around_the_critical_angle") {
  count_assertions("R at most 1, 1 beyond the angle");
  double critical = std::asin(1 / 1.5) * 180 / kPiD;
  CHECK(critical == doctest::Approx(41.8103).epsilon(1e-6));
  for (int i = -100; i <= 100; ++i) {
    double r = reflectance(critical + i * 2e-8 * 180 / kPiD, 1.5);
    CHECK((r > 0.9 && r <= 1));
  }
  for (double degrees = critical + 1e-4; degrees <= 90; degrees += 0.5) CHECK(reflectance(degrees, 1.5) == 1);
  CHECK(reflectance(critical - 0.1, 1.5) < 0.9);
}

// Goal: the exact Fresnel equations. Method: closed-form values, in both directions through the boundary.
TEST_CASE("hard_33_fresnel_closed_forms") {
  count_assertions("closed forms within 1e-6");
  const double known[][3] = {{0, 1.33, .0200593}, {0, 1.5, .04},      {0, 2.42, .172395},      {45, 1.5, .0502399},
                             {60, 1.5, .0891867}, {80, 1.5, .387704}, {56.3099, 1.5, .0739645}};
  for (const auto& row : known) CHECK(std::fabs(reflectance(row[0], 1 / row[1]) - row[2]) <= 1e-6);
  for (double degrees : {5.0, 30.0, 56.3099, 80.0, 89.0}) {  // reciprocity: the same from the other side
    double inside = std::asin(std::sin(degrees * kPiD / 180) / 1.5) * 180 / kPiD;
    CHECK(reflectance(degrees, 1 / 1.5) == doctest::Approx(reflectance(inside, 1.5)).epsilon(2e-5));
  }
}

// Goal: light that a surface does not reflect is transmitted: R + T = 1. Method: a slab of clear glass in uniform
// surroundings is invisible at any angle, up to what the maximum ray depth cuts off, r^16 at most.
TEST_CASE("hard_33_clear_glass_in_uniform_light_vanishes") {
  count_assertions("R + T = 1 within 1e-6");
  for (float ior : {1.33f, 1.5f, 2.42f}) {
    GeneratedScene s;
    add_box(&s, {-90, -90, -0.5f}, {90, 90, 0.5f}, add_material(&s, glass(ior)));
    s.scene.info.background = {1, 1, 1};
    auto t = ray_renderer(&s);
    for (double degrees : {0.0, 20.0, 45.0, 60.0, 75.0}) {
      double r = reflectance(degrees, 1 / double(ior)), x = std::tan(degrees * kPiD / 180);
      CAPTURE(ior);
      CAPTURE(degrees);
      float seen = look(*t, {float(-x), 0.1f, 1.5f}, {0, 0.1f, 0.5f}).x;
      CHECK(seen <= 1 + 1e-6);
      CHECK(seen >= 1 - std::pow(r, 15) - 1e-6);
    }
  }
}

// Goal: beyond the maximum depth the surroundings stand in for what would be seen: glass in uniform surroundings
// vanishes at every depth, and no cut-off makes it dark. Method: the slab again, seen at few depths.
TEST_CASE("hard_34_clear_glass_in_uniform_light_vanishes_at_every_depth") {
  count_assertions("1 within 1e-6");
  GeneratedScene s;
  add_box(&s, {-90, -90, -0.5f}, {90, 90, 0.5f}, add_material(&s, glass(1.5f)));
  s.scene.info.background = {1, 1, 1};
  for (std::uint32_t depth : {0u, 1u, 2u, 3u, 8u}) {
    CAPTURE(depth);
    CHECK(look(*ray_renderer(&s, depth), {-1.7f, 0.1f, 1.5f}, {0, 0.1f, 0.5f}).x == doctest::Approx(1).epsilon(1e-6));
  }
}

// Goal: a slab of n = 1.5 transmits 12/13 and reflects 1/13 at normal incidence. Method: closed form, and its partial
// sums at every ray depth: T = (1 − r)²·Σ r²ᵏ over the orders that fit.
TEST_CASE("hard_34_slab_transmits_12_of_13") {
  count_assertions("partial sums within 1e-5");
  for (bool beyond : {true, false}) {
    GeneratedScene s;
    add_box(&s, {-5, -5, -0.5f}, {5, 5, 0.5f}, add_material(&s, glass(1.5f)));
    add_sheet(&s, beyond ? -3.0f : 3.0f, add_material(&s, unlit(1)));
    for (std::uint32_t depth : {1u, 2u, 3u, 4u, 5u, 16u}) {
      double r = 0.04, sum = 0;
      if (beyond)
        for (std::uint32_t events = 2; events <= depth; events += 2) sum += (1 - r) * (1 - r) * std::pow(r, events - 2);
      else
        for (std::uint32_t events = 1; events <= depth; events += 2)
          sum += events == 1 ? r : (1 - r) * (1 - r) * std::pow(r, events - 2);
      CAPTURE(beyond);
      CAPTURE(depth);
      CHECK(look(*ray_renderer(&s, depth), {0.1f, 0.2f, 2}, {0.1f, 0.2f, 0}).x == doctest::Approx(sum).epsilon(1e-5));
      if (depth == 16) CHECK(sum == doctest::Approx(beyond ? 12.0 / 13 : 1.0 / 13).epsilon(1e-6));
    }
  }
}

namespace {

void add_facing_mirrors(GeneratedScene* s, float rho) {
  Material m = matte(0);
  m.mirror = {rho, rho, rho};
  m.emission = {1, 1, 1};
  std::uint32_t index = add_material(s, m);
  add_sheet(s, -1, index);
  add_sheet(s, 1, index, true);
}

}  // namespace

// Goal: facing mirrors of reflectance ρ and emission 1 show Σρᵏ. Method: closed form at every ray depth.
TEST_CASE("hard_35_facing_mirrors_sum_the_series") {
  count_assertions("partial sums within 1e-5");
  for (float rho : {0.5f, 0.9f, 1.0f}) {
    GeneratedScene s;
    add_facing_mirrors(&s, rho);
    double sum = 0;
    for (std::uint32_t depth = 0; depth <= 16; ++depth) {
      sum += std::pow(double(rho), depth);
      CAPTURE(depth);
      CHECK(look(*ray_renderer(&s, depth, 1), {0, 0, 0}, {0.03f, 0.02f, -1}).x == doctest::Approx(sum).epsilon(1e-5));
    }
  }
}

// Goal: where a path ends by its depth, the brighter of ambient light and background takes the place of the rest, and
// counts in the bound of radiance. Method: the series of facing mirrors, completed in closed form.
TEST_CASE("hard_35_surroundings_complete_the_series") {
  count_assertions("partial sums within 1e-5");
  const float rho = 0.5f;
  for (const Vec3& around : {Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{200, 0, 0}, Vec3{1, 200, 0}}) {
    GeneratedScene s;
    add_facing_mirrors(&s, rho);
    add_sheet(&s, 5, add_material(&s, matte(0.01f)));  // not seen; calls for ambient light
    s.scene.info.background = Vec3{1, 1, 1} * around.x, s.scene.info.ambient = Vec3{1, 1, 1} * around.y;
    double sum = 0;
    for (std::uint32_t depth = 0; depth <= 8; ++depth) {
      sum += std::pow(double(rho), depth);
      CAPTURE(around);
      CAPTURE(depth);
      auto t = ray_renderer(&s, depth, 1);
      double seen = sum + std::pow(double(rho), depth + 1) * double(max_component(around));
      CHECK(look(*t, {0, 0, 0}, {0.03f, 0.02f, -1}).x == doctest::Approx(seen).epsilon(1e-5));
      CHECK(double(t->renderer.frame.cut_off.radiance_bounds.after[depth]) >= seen * (1 - 1e-6));
    }
  }
}

// Goal: what ends by the maximum depth is counted, with the largest throughput. Method: closed form of
// facing mirrors; none where the path leaves the scene.
TEST_CASE("rays_that_end_by_depth_are_counted") {
  for (float rho : {0.5f, 0.25f}) {
    GeneratedScene s;
    add_facing_mirrors(&s, rho);
    for (std::uint32_t depth = 0; depth <= 6; ++depth) {
      auto t = ray_renderer(&s, depth, 1);
      Tracer tracer = make_tracer(t->renderer.frame);
      for (std::uint64_t rays = 1; rays <= 3; ++rays) {
        trace_ray(t->renderer, {0, 0, 0}, normalize(Vec3{0.03f, 0.02f, -1}), &tracer);
        CHECK(tracer.rays_ended == rays);
        CHECK(tracer.ended_weight_max == doctest::Approx(std::pow(double(rho), depth + 1)).epsilon(1e-6));
      }
      Tracer aside = make_tracer(t->renderer.frame);
      trace_ray(t->renderer, {0, 0, 0}, {1, 0, 0}, &aside);
      CHECK(aside.rays_ended == 0);
      CHECK(aside.ended_weight_max == 0);
    }
  }
}

// Goal: a path cut off at weight w errs by at most w/(1 − ρ), as it states, and by less than half a display level.
// Method: the series up to the maximum depth, for several exposures; rays are skipped, but none that matter.
TEST_CASE("hard_35_cut_off_errs_by_the_rest_of_the_series_at_most") {
  count_assertions("at most w/(1 - rho)");
  std::uint64_t left_out = 0;
  for (float rho : {0.3f, 0.5f, 0.6f})
    for (float exposure : {1.0f, 0.1f, 0.02f}) {
      GeneratedScene s;
      add_facing_mirrors(&s, rho);
      s.lights.resize(1);
      s.lights[0].intensity = {0, 0, 0};
      s.scene.info.exposure = exposure;
      aim(&s, {0, 0, 0}, {0.03f, 0.02f, -1}, 40);
      s.bind();
      Settings settings;
      settings.width = settings.height = 1;
      settings.ray_depth = 16;
      auto t = make_renderer(s.scene, settings);
      REQUIRE(render_frame(&t->renderer, 0).ok);
      Tracer counts = total_counts(t->renderer);
      double reflections = static_cast<double>(counts.rays[static_cast<int>(RayKind::mirror)]);
      double w = std::pow(double(rho), reflections + 1);
      double sum = (1 - std::pow(double(rho), settings.ray_depth + 1)) / (1 - double(rho));
      double error = sum - double(t->renderer.image[0].x);
      CAPTURE(rho);
      CAPTURE(exposure);
      CHECK(error >= -1e-6);
      CHECK(error <= w / (1 - double(rho)) + 1e-6);
      if (counts.rays_left_out > 0) CHECK(error <= double(counts.left_out_max) + 1e-6);
      if (counts.rays_left_out > 0) CHECK(counts.left_out_max <= kHalfLevel / exposure);
      left_out += counts.rays_left_out;
    }
  CHECK(left_out >= 6);
}

// Goal: a material that mirrors and transmits sends one reflected ray and one refracted. Method: counts, and the closed
// form of a thin sheet before unequal surroundings: (mirror + R)·above + (1 − R)·tint·below, R = 2r/(1 + r).
TEST_CASE("optics_mirror_and_glass_share_the_reflected_ray") {
  const float mirror = 0.3f, above = 1, below = 0.25f, tint = 0.5f;
  GeneratedScene s;
  Material sheet = glass(1.5f, Vec3{1, 1, 1} * tint);
  sheet.thin = 1, sheet.mirror = Vec3{1, 1, 1} * mirror;
  add_sheet(&s, 0, add_material(&s, sheet));
  add_sheet(&s, -1, add_material(&s, unlit(below)));
  s.scene.info.background = Vec3{1, 1, 1} * above;
  aim(&s, {0, 0, 1}, {0, 0, 0}, 1);
  s.bind();
  Settings settings;
  settings.width = settings.height = 1;
  auto t = make_renderer(s.scene, settings);
  REQUIRE(render_frame(&t->renderer, 0).ok);
  Tracer counts = total_counts(t->renderer);
  CHECK(counts.rays[static_cast<int>(RayKind::mirror)] == 1);
  CHECK(counts.rays[static_cast<int>(RayKind::refraction)] == 1);
  double r = 0.04, reflected = 2 * r / (1 + r);
  CHECK(double(t->renderer.image[0].x) ==
        doctest::Approx((double(mirror) + reflected) * double(above) + (1 - reflected) * double(tint * below))
            .epsilon(1e-5));
}

// Goal: a thin sheet passes 1 − 2r/(1 + r) of the light, unbent and tinted. Method: closed form.
TEST_CASE("optics_thin_sheet_closed_form") {
  GeneratedScene s;
  Material sheet = glass(1.5f, {0.5f, 1, 1});
  sheet.thin = 1;
  add_sheet(&s, 0, add_material(&s, sheet));
  add_sheet(&s, -1, add_material(&s, unlit(1)));
  auto t = ray_renderer(&s);
  for (double degrees : {0.0, 45.0, 80.0}) {
    double r = reflectance(degrees, 1 / 1.5), x = std::tan(degrees * kPiD / 180);
    Vec3 seen = look(*t, {float(-x), 0, 1}, {0, 0, 0});
    CHECK(seen.x == doctest::Approx(0.5 * (1 - 2 * r / (1 + r))).epsilon(1e-4));
    CHECK(seen.y == doctest::Approx(0.5 * (1 - 2 * r / (1 + r))).epsilon(1e-4));  // unlit(1) is {1, ½, ¼}
  }
}

// Goal: light inside a body fades as exp(−a·d), for the eye and for shadow rays. Method: closed form, a slab of index
// 1, so that nothing else affects the light.
TEST_CASE("optics_absorption_is_beer_lambert") {
  GeneratedScene s;
  add_box(&s, {-5, -5, 0.5f}, {5, 5, 2}, add_material(&s, glass(1, {1, 1, 1}, {0.7f, 0, 2})));
  add_sheet(&s, -1, add_material(&s, matte(0.8f)));
  Light light;
  light.kind = LightKind::directional;
  light.direction = {0, 0, -1};
  s.lights.push_back(light);
  auto t = ray_renderer(&s);
  Vec3 shaded = look(*t, {0.2f, 0.1f, 0.3f}, {0.2f, 0.1f, -1}), through = look(*t, {0.2f, 0.1f, 5}, {0.2f, 0.1f, -1});
  double lit = 0.8 / kPiD;
  for (int axis = 0; axis < 3; ++axis) {
    double a = axis == 0 ? 0.7 : axis == 1 ? 0 : 2, passes = std::exp(-a * 1.5);
    CHECK(shaded[axis] == doctest::Approx(lit * passes).epsilon(1e-5));
    CHECK(through[axis] == doctest::Approx(lit * passes * passes).epsilon(1e-5));
  }
}

// Goal: touching bodies count once each: no medium is lost at their common face, and the stack is empty behind them.
// Method: closed forms through stacks of touching slabs, for the eye and for shadow rays, with the bodies in either
// order.
TEST_CASE("hard_25_touching_bodies_balance") {
  count_assertions("Beer-Lambert, depth 0 at exit");
  for (bool swapped : {false, true}) {
    GeneratedScene s;
    std::uint32_t a = add_material(&s, glass(1, {1, 1, 1}, {0.3f, 0.3f, 0.3f})),
                  b = add_material(&s, glass(1, {1, 1, 1}, {1.1f, 1.1f, 1.1f}));
    auto lower = [&] { add_box(&s, {-5, -5, 0}, {5, 5, 1}, a); };
    auto upper = [&] { add_box(&s, {-4, -4, 1}, {6, 6, 3}, b); };
    if (swapped)
      upper(), lower();
    else
      lower(), upper();
    add_sheet(&s, -2, add_material(&s, matte(0.8f)));
    Light light;
    light.kind = LightKind::directional;
    light.direction = {0, 0, -1};
    s.lights.push_back(light);
    auto t = ray_renderer(&s);
    double once = std::exp(-0.3 - 2 * 1.1);
    CHECK(look(*t, {0.2f, 0.1f, -1}, {0.2f, 0.1f, -2}).x == doctest::Approx(0.8 / kPiD * once).epsilon(1e-5));
    CHECK(look(*t, {0.2f, 0.1f, 9}, {0.2f, 0.1f, -2}).x == doctest::Approx(0.8 / kPiD * once * once).epsilon(1e-5));
    CHECK(media_at(t->renderer.frame, {0.2f, 0.1f, 9}, {0, 0, -1}).depth == 0);
    CHECK(media_at(t->renderer.frame, {0.2f, 0.1f, 0.5f}, {0, 0, 1}).depth == 1);
    CHECK(media_at(t->renderer.frame, {0.2f, 0.1f, 0.5f}, {0, 0, 1}).material[0] == a);
    CHECK(media_at(t->renderer.frame, {0.2f, 0.1f, 2}, {0, 0, -1}).material[0] == b);
  }
}

// Goal: two touching slabs of the same glass are one slab: no reflection at the face between them. Method: closed form
// 12/13.
TEST_CASE("hard_25_touching_slabs_of_one_glass_are_one_slab") {
  count_assertions("12/13");
  for (bool one_material : {true, false}) {
    GeneratedScene s;
    std::uint32_t a = add_material(&s, glass(1.5f)), b = one_material ? a : add_material(&s, glass(1.5f));
    add_box(&s, {-5, -5, 0}, {5, 5, 1}, a);
    add_box(&s, {-5, -5, 1}, {5, 5, 2}, b);
    add_sheet(&s, -2, add_material(&s, unlit(1)));
    CHECK(look(*ray_renderer(&s), {0.2f, 0.1f, 9}, {0.2f, 0.1f, 0}).x == doctest::Approx(12.0 / 13).epsilon(1e-4));
  }
}

// Goal: glass that stands on a table does not hide it: the coincident face is not lost. Method: closed form through
// glass of index 1, rays all over it, with the glass before and after the table in the list of triangles.
TEST_CASE("hard_25_glass_on_a_table_shows_the_table") {
  count_assertions("the table is seen");
  for (bool glass_first : {true, false}) {
    GeneratedScene s;
    std::uint32_t clear = add_material(&s, glass(1)), table = add_material(&s, unlit(0.75f));
    if (glass_first) add_box(&s, {-1, -1, 0.3f}, {1, 1, 2}, clear);
    add_sheet(&s, 0.3f, table);
    if (!glass_first) add_box(&s, {-1, -1, 0.3f}, {1, 1, 2}, clear);
    auto t = ray_renderer(&s);
    Rng rng = make_rng(4);
    int wrong = 0;
    for (int i = 0; i < effort(20000); ++i) {
      Vec3 target = {2 * next_float(&rng) - 1, 2 * next_float(&rng) - 1, 0.3f};
      Vec3 from = {4 * next_float(&rng) - 2, 4 * next_float(&rng) - 2, 3};
      wrong += !(std::fabs(look(*t, from, target).x - 0.75f) < 1e-5f);
    }
    CHECK(wrong == 0);
  }
}

// Goal: nested media and an eye inside glass: the stack has the bodies around the eye, innermost last. Method: three
// nested boxes, the eye in each, rays in all directions.
TEST_CASE("hard_25_media_around_the_eye") {
  count_assertions("the bodies around the eye");
  GeneratedScene s;
  for (float side : {3.0f, 2.0f, 1.0f})
    add_box(&s, {-side, -side, -side}, {side, side, side}, add_material(&s, glass(1.0f + side / 10)));
  auto t = ray_renderer(&s);
  Rng rng = make_rng(5);
  for (std::uint32_t depth = 0; depth <= 3; ++depth)
    for (int i = 0; i < 200; ++i) {
      Vec3 eye = {3.5f - static_cast<float>(depth), 0.1f, -0.2f};
      Vec3 direction = normalize(Vec3{next_float(&rng) - 0.5f, next_float(&rng) - 0.5f, next_float(&rng) - 0.5f});
      MediumStack media = media_at(t->renderer.frame, eye, direction);
      REQUIRE(media.depth == depth);
      for (std::uint32_t k = 0; k < depth; ++k) REQUIRE(media.material[k] == k);
    }
}
