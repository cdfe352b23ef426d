#include "shade/branches.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/color.h"
#include "plan/radiance_bounds.h"
#include "shade/pixel.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// Hollow spheres of glass, one in the other, over a floor before a wall.
struct Nest {
  int count = 5;
  float ior = 1.5f;
  Vec3 tint = {1, 1, 1};
  bool has_lamp = false;  // above; shines down
};
std::unique_ptr<GeneratedScene> make_nest(const Nest& nest) {
  auto s = std::make_unique<GeneratedScene>();
  Material glass, floor, wall, lamp;
  glass.diffuse = {0, 0, 0}, glass.transmission = nest.tint, glass.ior = nest.ior;
  floor.diffuse = {.7f, .6f, .4f}, wall.diffuse = {.2f, .4f, .7f};
  lamp.diffuse = {0, 0, 0}, lamp.emission = {20, 20, 20};
  const std::uint32_t in_glass = add_material(s.get(), glass);
  for (int i = 0; i < nest.count; ++i) {
    const float radius = 1 - .18f * static_cast<float>(i);
    add_sphere(s.get(), {0, 0, 0}, radius, 16, 10, in_glass);
    add_sphere(s.get(), {0, 0, 0}, -.95f * radius, 16, 10, in_glass);  // fronts inside
  }
  add_quad(s.get(), {-4, -1.01f, 4}, {4, -1.01f, 4}, {4, -1.01f, -4}, {-4, -1.01f, -4}, add_material(s.get(), floor));
  add_quad(s.get(), {-4, -1.01f, -3}, {4, -1.01f, -3}, {4, 4, -3}, {-4, 4, -3}, add_material(s.get(), wall));
  if (nest.has_lamp)
    add_quad(s.get(), {-.5f, 5, -.5f}, {.5f, 5, -.5f}, {.5f, 5, .5f}, {-.5f, 5, .5f}, add_material(s.get(), lamp));
  Light light;
  light.kind = LightKind::point, light.position = {2, 3, 2}, light.intensity = {20, 20, 20};
  s->lights.push_back(light);
  s->scene.info.background = {.1f, .15f, .2f};
  s->scene.info.ambient = {.3f, .3f, .3f};
  s->with_normals = true;
  aim(s.get(), {0, .6f, 3.6f}, {0, 0, 0}, 40);
  s->bind();
  return s;
}

Settings nest_settings(std::uint32_t depth, float cut_off, unsigned width = 32, unsigned height = 24) {
  Settings settings = settings_for(bit(Feature::point_light) | bit(Feature::refraction), width, height);
  settings.ray_depth = depth, settings.cut_off_levels = cut_off;
  settings.points_per_area_light = 1;
  return settings;
}

std::uint64_t secondary_rays(const Tracer& t) {
  return t.rays[static_cast<int>(RayKind::mirror)] + t.rays[static_cast<int>(RayKind::refraction)];
}

const Nest kNests[] = {{1, 1.5f, {1, 1, 1}, false},
                       {2, 2.4f, {1, 1, 1}, true},
                       {3, 1.33f, {.9f, .7f, .5f}, false},
                       {5, 1.5f, {1, 1, 1}, true}};

}  // namespace

// Goal: no ray of nested glass exceeds its bound. Method: sampling, from everywhere to everywhere, at several depths.
TEST_CASE("radiance_bounds_hold_in_nested_glass") {
  for (const Nest& nest : kNests)
    for (std::uint32_t depth : {0u, 2u, 6u}) {
      auto s = make_nest(nest);
      auto t = make_renderer(s->scene, nest_settings(depth, 0));
      Rng rng = make_rng(depth + 1);
      auto between = [&](float low, float high) { return low + (high - low) * next_float(&rng); };
      for (int i = 0; i < effort(4000); ++i) {
        const Vec3 from = {between(-4.5f, 4.5f), between(-1.2f, 5.2f), between(-3.2f, 4.2f)};
        const Vec3 to = {between(-4, 4), between(-1, 5), between(-3, 4)};
        CHECK(max_component(trace_ray(t->renderer, from, normalize(to - from))) <=
              t->renderer.frame.cut_off.radiance_bounds.after[depth]);
      }
    }
}

// Goal: glass bounds what it passes on by what it can see, however many surfaces follow, and surfaces that end paths
// add nothing. Method: invariant: with glass that neither shines nor scatters, the bound is the same at each depth.
TEST_CASE("radiance_bound_does_not_grow_in_glass") {
  auto s = make_nest(kNests[3]);
  auto t = make_renderer(s->scene, nest_settings(16, 0));
  const RadianceBounds& bounds = t->renderer.frame.cut_off.radiance_bounds;
  for (std::uint32_t i = 1; i <= kRayDepthMax; ++i) CHECK(bounds.after[i] == bounds.after[1]);
  CHECK(bounds.after[0] >= 20);
  CHECK(bounds.after[16] <= 23);  // the lamp, rounded up by at most an eighth
}

// Goal: what stands in for rays that end errs by no more than the bound that is told. Method: differential: the same
// rays with a depth of 10.
TEST_CASE("ended_rays_err_within_their_bound") {
  for (const Nest& nest : kNests)
    for (std::uint32_t depth : {0u, 1u, 3u, 5u}) {
      auto s = make_nest(nest);
      auto shallow = make_renderer(s->scene, nest_settings(depth, 0));
      auto deep = make_renderer(s->scene, nest_settings(10, 0));
      Rng rng = make_rng(depth + 7);
      double most = 0;
      for (int i = 0; i < effort(40); ++i) {
        const float x = 1.2f * (next_float(&rng) - .5f), y = 1.2f * (next_float(&rng) - .5f);
        const Vec3 eye = {0, .6f, 3.6f}, direction = normalize(Vec3{x, y - .3f, -2});
        Tracer counts = make_tracer(shallow->renderer.frame);
        const Vec3 seen = trace_ray(shallow->renderer, eye, direction, &counts);
        const Vec3 exact = trace_ray(deep->renderer, eye, direction);
        const double difference = double(max_component(max(seen - exact, exact - seen)));
        CAPTURE(depth);
        CAPTURE(i);
        CHECK(difference <= double(counts.branching.ended) + 1e-5 * double(max_component(exact)));
        CHECK((counts.branching.ended > 0) == (counts.rays_ended > 0));
        if (counts.branching.ended > 0) most = std::max(most, difference / double(counts.branching.ended));
      }
      if (depth < 5 && kEffortDivisor == 1) CHECK(most > 1e-3);
    }
}

// Goal: the picture's bound is the largest of its samples', and none is told where no ray ends. Method: equivalence
// with each pixel's ray traced alone.
TEST_CASE("ended_bound_is_the_largest_of_the_picture") {
  auto s = make_nest(kNests[0]);
  for (std::uint32_t depth : {1u, 4u}) {
    auto t = make_renderer(s->scene, nest_settings(depth, 0, 16, 12));
    REQUIRE(render_frame(&t->renderer, 0).ok);
    float most = 0;
    for (std::uint32_t row = 0; row < 12; ++row)
      for (std::uint32_t column = 0; column < 16; ++column) {
        const Ray ray = pixel_ray(t->renderer.frame, column, row, {.5f, .5f});
        Tracer counts = make_tracer(t->renderer.frame);
        trace_ray(t->renderer, ray.origin, ray.direction, &counts);
        most = std::max(most, counts.branching.ended);
      }
    CHECK(total_counts(t->renderer).ended_bound_max == most);
    CHECK(most > 0);
  }
}

// Goal: what is left out of a tree of rays stays below what is told, and below half a display level of the pixel as it
// is. Method: differential, with and without the cut-off.
TEST_CASE("cut_off_is_bounded_in_nested_glass") {
  const unsigned width = effort_side(32), height = effort_side(24);
  for (const Nest& nest : kNests)
    for (std::uint32_t depth : {3u, 7u, 9u}) {
      auto s = make_nest(nest);
      auto with = make_renderer(s->scene, nest_settings(depth, .5f, width, height)),
           without = make_renderer(s->scene, nest_settings(depth, 0, width, height));
      const Renderer &a = with->renderer, &b = without->renderer;
      REQUIRE(render_frame(&with->renderer, 0).ok);
      REQUIRE(render_frame(&without->renderer, 0).ok);
      const Tracer counts = total_counts(a);
      CAPTURE(nest.count);
      CAPTURE(depth);
      CHECK(counts.left_out_share_max <= 1.00001f);
      CHECK(total_counts(b).rays_left_out == 0);
      if (depth > 3 && kEffortDivisor == 1) CHECK(secondary_rays(counts) < secondary_rays(total_counts(b)));
      for (std::uint32_t i = 0; i < a.image.count; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const double left = double(a.image[i][axis]), right = double(b.image[i][axis]);
          CHECK(std::fabs(left - right) <= double(counts.left_out_max) + 1e-5 * right);
          const int levels =
              srgb_level(a.image[i][axis] * a.view.exposure) - srgb_level(b.image[i][axis] * b.view.exposure);
          CHECK(std::abs(levels) <= 1);
        }
    }
}

// Goal: the tree of rays of five hollow spheres stays small at the greatest depth, where one pixel can have 2^16
// rays: 2 300 a pixel, and 5 100 if one ray may take all that a sample may lose. Method: count.
TEST_CASE("nested_glass_takes_few_rays") {
  const unsigned width = effort_side(32), height = effort_side(24);
  auto s = make_nest(kNests[3]);
  auto t = make_renderer(s->scene, nest_settings(16, .5f, width, height));
  REQUIRE(render_frame(&t->renderer, 0).ok);
  const Tracer counts = total_counts(t->renderer);
  const double rays = double(secondary_rays(counts)) / (width * height);
  std::printf("five hollow spheres at depth 16: %.0f secondary rays a pixel, %.2f of the allowance used\n", rays,
              double(counts.left_out_share_max));
  if (kEffortDivisor == 1) CHECK(rays <= 2600);
}

// Goal: what a sample may lose is at most half a display level at its brightness. Method: sRGB in double precision.
TEST_CASE("display_levels_are_as_wide_as_the_cut_off_takes_them") {
  auto encode = [](double x) { return x <= .0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - .055; };
  double most = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const double light = i * 1e-6;
    const double allowed = double(kHalfLevel) * (1 + double(kLevelSlope) * std::max(light - double(kDarkLevels), 0.0));
    most = std::max(most, 255 * (encode(light + allowed) - encode(light)));
  }
  CHECK(most <= .5 * (1 + 1e-6));
}

// Goal: the bound covers all the reflections that an ended ray would have met. Method: closed form of facing mirrors
// that shine: 1 + ρ + ρ² + …, of which depth N lacks ρ^(N+1) / (1 − ρ).
TEST_CASE("ended_rays_between_mirrors_err_within_their_bound") {
  GeneratedScene s;
  Material shining;
  shining.diffuse = {0, 0, 0}, shining.emission = {1, 1, 1}, shining.mirror = {.5f, .5f, .5f};
  const std::uint32_t material = add_material(&s, shining);
  add_quad(&s, {-50, -50, -1}, {50, -50, -1}, {50, 50, -1}, {-50, 50, -1}, material);
  add_quad(&s, {50, -50, 1}, {-50, -50, 1}, {-50, 50, 1}, {50, 50, 1}, material);
  aim(&s, {0, 0, 0}, {0, 0, -1}, 40);
  s.bind();
  for (std::uint32_t depth = 0; depth <= 6; ++depth) {
    auto t = make_renderer(s.scene, nest_settings(depth, 0));
    Tracer counts = make_tracer(t->renderer.frame);
    const double seen = double(trace_ray(t->renderer, {0, 0, 0}, normalize(Vec3{.03f, .02f, -1}), &counts).x);
    CAPTURE(depth);
    CHECK(2 - seen == doctest::Approx(std::pow(.5, depth)).epsilon(1e-4));
    CHECK(2 - seen <= double(counts.branching.ended));
    CHECK(double(counts.branching.ended) <= 1.2 * (2 - seen));  // rounded up by at most an eighth
  }
}
