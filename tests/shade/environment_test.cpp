// Environments as the renderer shows and reflects them.
#include <doctest/doctest.h>

#include "brdf/brdf_list.h"
#include "indirect/environment.h"
#include "shade_helpers.h"
#include "support/effort.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

Material metal(float alpha) {
  Material m;
  m.diffuse = {0, 0, 0}, m.specular = {1, 0.7f, 0.4f};
  m.brdf = kGgx, m.roughness = alpha, m.grazing = 1;
  return m;
}

// Directions by their colour, in every level.
TestEnvironment colorful() {
  return TestEnvironment(32, 16, {0.5f, 0.5f, 0.5f}, [](const Vec3d& d, int) {
    return Vec3d{1 + d.x, 1 + d.y, 1 + d.z};
  });
}

// What a ray sees of a sheet of the material in z = 0, or of nothing.
Vec3 seen(const TestEnvironment* environment, const Material& m, const Vec3& eye, float ambient = 0,
          std::uint32_t depth = 4) {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, m));
  if (environment) environment->give(&s.scene);
  s.scene.info.ambient = s.scene.info.background = {ambient, ambient, ambient};
  auto t = ray_renderer(&s, depth);
  return look(*t, eye, {0, 0, 0});
}

}  // namespace

// Goal: white furnace: an even environment lights diffuse, glossy and mirroring surfaces and glass exactly as the same
// radiance of ambient light and background does, at any depth. Method: the closed form of the one against the other;
// GGX within the rounding of its filter.
TEST_CASE("environment_even_lights_as_ambient_light_does") {
  const TestEnvironment even = even_environment({1, 1, 1});
  Material mirror = matte(0), plastic = metal(0.3f);
  mirror.mirror = {0.9f, 0.8f, 0.7f};
  plastic.diffuse = {0.4f, 0.5f, 0.6f}, plastic.specular = {0.04f, 0.04f, 0.04f};
  for (const Vec3& eye : {Vec3{0, 0, 3}, Vec3{2, 0.5f, 1}, Vec3{5, 1, 0.3f}})
    for (std::uint32_t depth : {0u, 1u, 4u})
      for (const Material& m : {matte(0.6f), mirror, metal(0.01f), metal(0.2f), metal(1), plastic, glass(1.5f)}) {
        const Vec3 found = seen(&even, m, eye, 0, depth), expected = seen(nullptr, m, eye, 1, depth);
        CAPTURE(m.roughness);
        CAPTURE(depth);
        for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(expected[c]).epsilon(1e-6));
      }
}

// Goal: the camera, mirrors and glass see the direction of their ray; beyond the maximum depth, too. Method: an
// environment whose radiance is linear in the direction.
TEST_CASE("environment_is_seen_where_rays_go") {
  const TestEnvironment sky = colorful();
  GeneratedScene nothing;
  add_sheet(&nothing, -99, add_material(&nothing, matte(0)), true, 0.001f);
  sky.give(&nothing.scene);
  auto t = ray_renderer(&nothing);
  for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0.6f, 0.8f, 0}, Vec3{-0.6f, 0, -0.8f}, Vec3{0, -0.8f, 0.6f}}) {
    const Vec3 found = trace_ray(t->renderer, {0, 0, 0}, d);
    for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(1 + d[c]).epsilon(0.02));
  }
  Material mirror = matte(0);
  mirror.mirror = {1, 1, 1};
  for (std::uint32_t depth : {0u, 3u}) {
    const Vec3 reflected = seen(&sky, mirror, {0.6f, 0, 0.8f}, 0, depth);
    for (int c = 0; c < 3; ++c) CHECK(reflected[c] == doctest::Approx(1 + Vec3{-0.6f, 0, 0.8f}[c]).epsilon(0.02));
  }
  Material sheet = glass(1);
  sheet.thin = 1;
  const Vec3 passed = seen(&sky, sheet, {0.6f, 0, 0.8f});
  for (int c = 0; c < 3; ++c) CHECK(passed[c] == doctest::Approx(1 + Vec3{-0.6f, 0, -0.8f}[c]).epsilon(0.02));
}

// Goal: metals under an environment are never black, and take the colour of what they reflect. Method: the split sum
// against the table's albedo times the radiance in the mirrored direction, for the roughest along the normal, as the
// lobe's middle turns; light scattered more than once comes from about all directions, of which the sky has an
// irradiance of its own.
TEST_CASE("environment_colors_metals") {
  const TestEnvironment sky = colorful();
  for (float alpha : {0.01f, 0.1f, 0.5f, 1.0f}) {
    const Material m = metal(alpha);
    const Vec3 found = seen(&sky, m, {0.6f, 0, 0.8f});
    const BrdfAlbedo albedo = kGgxBrdf.albedo(m, m.specular, 0.8f);
    const Vec3 mirrored = alpha < 0.5f ? Vec3{0.4f, 1, 1.8f} : alpha == 1 ? Vec3{1, 1, 2} : Vec3{0.62f, 1, 1.92f};
    const Vec3 mean = {0.5f, 0.5f, 0.5f};
    for (int c = 0; c < 3; ++c)
      CHECK(found[c] == doctest::Approx(albedo.once[c] * mirrored[c] + albedo.scattered[c] * mean[c]).epsilon(0.05));
    CHECK(found.z > 0.1f);
  }
}

// Goal: no pixel exceeds the bound that decides which rays are skipped, and with and without --cut-off they differ by
// at most what it states. Method: generated scenes of every feature under a bright environment.
TEST_CASE("environment_is_within_the_bound_of_radiance") {
  const TestEnvironment sky(16, 8, {4, 4, 4}, [](const Vec3d& d, int) {
    return d.y > 0.9 ? Vec3d{40, 40, 40} : Vec3d{0.5, 0.6, 0.7};
  });
  for (std::uint64_t seed : {1u, 2u, 3u}) {
    const std::uint32_t features = kAllFeatures & ~bit(Feature::animation);
    auto s = generate_scene(features, seed);
    sky.give(&s->scene);
    Settings settings = settings_for(features, effort_side(32), effort_side(24));
    settings.cut_off_levels = 0;
    auto whole = make_renderer(s->scene, settings);
    REQUIRE(whole);
    REQUIRE(render_frame(&whole->renderer, 0).ok);
    settings.cut_off_levels = 4;
    auto cut = make_renderer(s->scene, settings);
    REQUIRE(render_frame(&cut->renderer, 0).ok);
    CHECK(total_counts(cut->renderer).rays_left_out > 0);
    const float most = total_counts(cut->renderer).left_out_max;
    CHECK(total_counts(cut->renderer).left_out_share_max <= 1.00001f);
    const float bound = whole->renderer.frame.cut_off.radiance_bounds.after[settings.ray_depth];
    for (std::uint32_t i = 0; i < settings.width * settings.height; ++i) {
      const Vec3 a = whole->renderer.image[i], b = cut->renderer.image[i];
      CHECK(max_component(a) <= bound);
      CHECK(max_component(abs(a - b)) <= most * 1.01f + 1e-5f * max_component(a));
    }
  }
}

// Goal: the picture does not depend on threads, and forcing every effect on changes nothing: with an environment, and
// without one that could be shown.
TEST_CASE("environment_pictures_do_not_depend_on_threads_or_forced_effects") {
  const TestEnvironment sky = colorful();
  for (int with = 0; with < 4; ++with) {
    const bool has_one = with & 1, has_ambient = with & 2;
    auto s = generate_scene(kAllFeatures & ~(has_ambient ? 0 : bit(Feature::ambient)), 5);
    if (has_one) sky.give(&s->scene);
    CAPTURE(has_one);
    CAPTURE(has_ambient);
    Settings settings = settings_for(kAllFeatures, effort_side(40), effort_side(30));
    const Picture one = render_picture(s->scene, settings);
    settings.threads = 3;
    CHECK(same_picture(one, render_picture(s->scene, settings)));
    settings.forced_on = kAllEffects & ~bit(Effect::selective);
    CHECK(same_picture(one, render_picture(s->scene, settings)));
    settings.forced_on = 0, settings.forced_off = bit(Effect::environment);
    CHECK(same_picture(one, render_picture(s->scene, settings)) != has_one);
  }
}
