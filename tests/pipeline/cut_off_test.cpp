#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/color.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

struct Comparison {
  double difference_max = 0;  // linear, in excess of the rounding of the sums
  double left_out_max = 0;
  double share_max = 0;  // of what may be left out of a sample, which grows with its light where paths branch
  int level_difference_max = 0;
  std::uint64_t rays_left_out = 0, rays_left_out_without = 0, rays_with = 0, rays_without = 0;
};

std::uint64_t all_rays(const Tracer& t) {
  std::uint64_t sum = 0;
  for (std::uint64_t rays : t.rays) sum += rays;
  return sum;
}

Comparison compare_cut_off(const Scene& scene, Settings settings) {
  Comparison c;
  settings.cut_off_levels = 0.5f;
  auto with = make_renderer(scene, settings);
  settings.cut_off_levels = 0;
  auto without = make_renderer(scene, settings);
  Renderer &a = with->renderer, &b = without->renderer;
  REQUIRE(render_frame(&a, 0).ok);
  REQUIRE(render_frame(&b, 0).ok);
  Tracer ta = total_counts(a), tb = total_counts(b);
  c.left_out_max = ta.left_out_max, c.share_max = ta.left_out_share_max;
  c.rays_left_out = ta.rays_left_out, c.rays_left_out_without = tb.rays_left_out;
  c.rays_with = all_rays(ta), c.rays_without = all_rays(tb);
  for (std::uint32_t i = 0; i < a.image.count; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      double left = a.image[i][axis], right = b.image[i][axis];
      double difference = std::fabs(left - right) - 1e-6 * right;  // a dozen sums, each rounded at 6e-8
      if (difference > c.difference_max) c.difference_max = difference;
      int levels =
          std::abs(srgb_level(a.image[i][axis] * a.view.exposure) - srgb_level(b.image[i][axis] * b.view.exposure));
      if (levels > c.level_difference_max) c.level_difference_max = levels;
    }
  return c;
}

// Without the cut-off, the number of rays grows exponentially with the depth where coats have normals of their own.
bool has_coats(std::uint32_t features) { return (features & bit(Feature::clear_coat)) != 0; }

void check_bounded(const Comparison& c) {
  CHECK(c.difference_max <= c.left_out_max);
  CHECK(c.share_max <= 1.00001);  // rounding of the sums
  CHECK(c.level_difference_max <= 1);
  CHECK(c.rays_left_out_without == 0);
  CHECK(c.rays_with <= c.rays_without);
}

}  // namespace

// Goal: the radiance that the cut-off skips stays below the amount it reports, that below half a level, and no display
// level changes by more than one. Method: differential, with and without, on the Cornell box.
TEST_CASE("cut_off_is_bounded_on_cornell") {
  auto built = build_builtin("cornell");
  Settings settings;
  settings.width = effort_side(96), settings.height = effort_side(72);
  Comparison c = compare_cut_off(built->scene, settings);
  check_bounded(c);
  CHECK(c.rays_left_out > 0);
}

// Goal and method as above, on generated scenes with mirrors, glass and blending, where paths branch and fade.
TEST_CASE("cut_off_is_bounded_on_generated_scenes") {
  const std::uint32_t lit = bit(Feature::point_light) | bit(Feature::ambient);
  const std::uint32_t sets[] = {lit | bit(Feature::mirror), lit | bit(Feature::refraction) | bit(Feature::absorption),
                                lit | bit(Feature::alpha_blend) | bit(Feature::alpha_mask), lit | bit(Feature::thin),
                                kAllFeatures & ~bit(Feature::animation)};
  std::uint64_t left_out = 0;
  for (std::uint32_t features : sets)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      auto generated = generate_scene(features, seed);
      for (Material& m : generated->materials)
        if (!is_zero(m.mirror)) m.mirror = {0.05f, 0.05f, 0.05f};  // faint enough for the cut-off
      generated->scene.info.exposure = seed % 2 ? 0.02f : 1.0f;
      Settings settings = settings_for(features, effort_side(48), effort_side(36));
      settings.ray_depth = has_coats(features) ? 5 : 16;
      Comparison c = compare_cut_off(generated->scene, settings);
      CAPTURE(features);
      CAPTURE(seed);
      check_bounded(c);
      left_out += c.rays_left_out;
    }
  CHECK(left_out > static_cast<std::uint64_t>(effort(1000)));
}

// Goal: no ray exceeds the bound that the cut-off relies on, whatever number of bounces remains. Method: sampling, rays
// from everywhere to everywhere through scenes with every kind of light and surface, at every depth up to 8; the bounds
// at depth 8.
TEST_CASE("radiance_bound_bounds_every_ray") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::uint32_t features = (kAllFeatures & ~bit(Feature::supersampling)) ^ (seed % 2 ? bit(Feature::refraction) : 0u);
    auto generated = generate_scene(features, seed);
    Settings settings = settings_for(features, 8, 6);
    settings.cut_off_levels = 0;
    auto deepest = make_renderer(generated->scene, settings);
    const RadianceBounds bounds = deepest->renderer.frame.cut_off.radiance_bounds;
    settings.ray_depth = static_cast<std::uint32_t>(seed % 9);
    const float bound = bounds.after[settings.ray_depth];
    REQUIRE(std::isfinite(bound));
    CHECK(bound <= bounds.after[8]);
    auto test = make_renderer(generated->scene, settings);
    const Renderer& renderer = test->renderer;
    Rng rng = make_rng(seed);
    auto between = [&](float low, float high) { return low + (high - low) * next_float(&rng); };
    float most = 0;
    for (int i = 0; i < effort(4000); ++i) {
      Vec3 from = {between(-3, 3), between(0, 3), between(-2.4f, 3)},
           to = {between(-3, 3), between(0, 3), between(-2.4f, 3)};
      most = std::max(most, max_component(trace_ray(renderer, from, normalize(to - from))));
    }
    CAPTURE(seed);
    CHECK(most <= bound);
    CHECK(most > 0.01f);
  }
}

// Goal: the bound is not far above the real maximum. Method: closed form, one mirror facing an emitter: L = Le + ρ·Le.
TEST_CASE("radiance_bound_is_reached_by_a_mirror_before_an_emitter") {
  GeneratedScene s;
  Material lamp, mirror;
  lamp.diffuse = mirror.diffuse = {0, 0, 0};
  lamp.emission = {2, 2, 2};
  lamp.mirror = {0.5f, 0.5f, 0.5f};
  mirror.mirror = {0.5f, 0.5f, 0.5f};
  add_quad(&s, {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, add_material(&s, lamp));
  add_quad(&s, {1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, add_material(&s, mirror));
  aim(&s, {0, 0, 0}, {0, 0, -1}, 40);
  s.bind();
  Settings settings = settings_for(0, 4, 3);
  settings.ray_depth = 16;
  settings.cut_off_levels = 0;
  auto test = make_renderer(s.scene, settings);
  float seen = trace_ray(test->renderer, {0, 0, 0}, {0, 0, -1}).x;
  const float bound = test->renderer.frame.cut_off.radiance_bounds.after[settings.ray_depth];
  CHECK(seen <= bound);
  CHECK(bound <=
        4 * 1.13f);  // 2/(1 − ½), all surfaces assumed as strong as the strongest, rounded up by at most an eighth
  CHECK(seen == doctest::Approx(2 / 0.75).epsilon(1e-4));  // Σ (ρ²)ᵏ · 2
}
