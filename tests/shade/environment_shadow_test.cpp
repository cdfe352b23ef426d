// Shadows from the environment: closed forms, what they leave alone, and that a picture does not depend on how it is
// divided.
#include <doctest/doctest.h>

#include <algorithm>

#include "accel/accel_list.h"
#include "indirect/environment.h"
#include "shade/interleaved.h"
#include "shade_helpers.h"
#include "support/divided_picture.h"
#include "support/effort.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

Settings with_directions(std::uint32_t count, std::uint32_t width = 16, std::uint32_t height = 16) {
  Settings settings = settings_for(0, width, height);
  settings.environment_shadows = count;
  return settings;
}

// Brighter above, with a bright spot.
TestEnvironment sky() {
  return TestEnvironment(32, 32, {0.5f, 0.6f, 0.7f}, [](const Vec3d& d, int) {
    return d.x > 0.9 ? Vec3d{20, 18, 15} : Vec3d{1 + d.y, 1.2 + d.y, 1.5 + d.y};
  });
}

// A horizontal square of half side `half` at height y, one material of albedo 1, and a camera that looks down at the
// origin from little above it, over a field of view so narrow that all pixels show one point.
struct Floor : GeneratedScene {
  explicit Floor(float half = 1) {
    add_material(this, matte(1));
    add_square(0, half);
    Camera camera;
    camera.eye = {0.01f, 0.1f, 0.02f}, camera.target = {0, 0, 0}, camera.up = {1, 0, 0};
    camera.vertical_fov = 0.01f;
    cameras = {camera};
    lights.resize(1);  // a dark one, to avoid default lights
    lights[0].intensity = {0, 0, 0};
  }
  void add_square(float y, float half, std::uint32_t material = 0) {
    add_box(this, {-half, y - 0.001f * half, -half}, {half, y, half}, material);
  }
};

// Mean of the picture's pixels.
Vec3 seen(GeneratedScene* s, const TestEnvironment& environment, const Settings& settings) {
  s->bind();
  environment.give(&s->scene);
  auto t = make_renderer(s->scene, settings);
  REQUIRE(t);
  REQUIRE(render_frame(&t->renderer, 0).ok);
  Vec3 sum = {0, 0, 0};
  for (const Vec3& pixel : t->renderer.image) sum += pixel;
  return sum * (1 / static_cast<float>(t->renderer.image.count));
}

}  // namespace

// Goal: the share of an even environment that something hides. Method: closed forms of configuration factors: a wall
// that stands on the floor, a square above the floor, a closed box; all directions count.
TEST_CASE("environment_shadow_hides_configuration_factors") {
  const TestEnvironment even = even_environment({1, 0.5f, 0.25f});
  auto is = [](const Vec3& found, double open, double tolerance) {
    CHECK(found.x == doctest::Approx(open).epsilon(tolerance));
    CHECK(found.y == doctest::Approx(open / 2).epsilon(tolerance));
    CHECK(found.z == doctest::Approx(open / 4).epsilon(tolerance));
  };
  const Settings settings = with_directions(256);
  Floor plain(1000);
  is(seen(&plain, even, settings), 1, 1e-6);
  Floor walled(1000);
  add_box(&walled, {-1000, 0, -1000}, {-0.05f, 1e6f, 1000}, 0);  // behind the point
  is(seen(&walled, even, settings), 0.5, 0.04);
  for (float half : {0.5f, 1.0f, 2.0f}) {  // [Howell, factor B-4] of a quarter, four times
    Floor covered(1000);
    covered.add_square(1, half);
    const double a = half, b = a / std::sqrt(1 + a * a), factor = 4 * (2 * b * std::atan(b)) / (2 * kPi);
    is(seen(&covered, even, settings), 1 - factor, 0.05);
  }
  Floor closed(1);
  add_box(&closed, {-1, -1, -1}, {1, 1, 1}, 0);
  is(seen(&closed, even, settings), 0, 0.001);
}

// Goal: where nothing is in the way, the light is that without shadows, bit for bit, in any number of directions; and
// mirrors, metals and unlit surfaces take no part. Method: a lone body under an uneven sky, with and without.
TEST_CASE("environment_shadow_leaves_open_surfaces_alone") {
  const TestEnvironment uneven = sky();
  for (std::uint32_t count : {1u, 7u, 16u, 64u, 250u}) {
    Floor floor;
    floor.cameras[0].eye = {2, 3, 1}, floor.cameras[0].vertical_fov = 0.6f;
    Material metal = matte(0);
    metal.specular = {1, 0.7f, 0.4f}, metal.brdf = kGgx, metal.roughness = 0.3f, metal.grazing = 1;
    add_box(&floor, {-5, -2, -5}, {5, -1.5f, 5}, add_material(&floor, metal));  // shadowed, but not diffuse
    const Vec3 with = seen(&floor, uneven, with_directions(count)), without = seen(&floor, uneven, with_directions(0));
    CHECK(with == without);
  }
}

// Goal: surfaces seen in a mirror lie in these shadows. Method: a mirror above the point, which it hides little of; a
// wall behind the point hides half of the sky in closed form, a closed box all of it.
TEST_CASE("environment_shadow_is_seen_in_mirrors") {
  const TestEnvironment even = even_environment({1, 1, 1});
  Material mirror = matte(0);
  mirror.mirror = {1, 1, 1};
  auto seen_in_mirror = [&](Floor* floor) {
    const std::uint32_t m = add_material(floor, mirror);
    add_box(floor, {0.3f, 0.4f, 0.3f}, {0.34f, 0.44f, 0.34f}, m);  // its lower side
    floor->cameras[0].eye = {0.32f, 0.1f, 0.32f}, floor->cameras[0].target = {0.321f, 0.4f, 0.322f};
    floor->cameras[0].vertical_fov = 0.06f;
    return seen(floor, even, with_directions(64));
  };
  Floor open(1000), walled(1000), closed(1);
  CHECK(seen_in_mirror(&open).x == doctest::Approx(1).epsilon(0.03));
  add_box(&walled, {-1000, 0, -1000}, {0.2f, 1e6f, 1000}, 0);
  CHECK(seen_in_mirror(&walled).x == doctest::Approx(0.5).epsilon(0.06));
  add_box(&closed, {-1, -1, -1}, {1, 1, 1}, 0);
  CHECK(seen_in_mirror(&closed).x == 0);
}

// Goal: pixels on one surface take light from all lights of four patterns, each light once. Method: the share of these
// that a square above hides, at several heights, where all pixels show one point.
TEST_CASE("environment_shadow_takes_light_from_four_patterns") {
  const TestEnvironment uneven = sky();
  for (float height : {0.3f, 0.5f, 0.8f, 1.3f}) {
    Floor covered(1000);
    covered.add_square(height, 1);
    covered.bind();
    uneven.give(&covered.scene);
    auto t = make_renderer(covered.scene, with_directions(16));
    REQUIRE(render_frame(&t->renderer, 0).ok);
    const EnvironmentLights& lights = *t->renderer.frame.environment_lights;
    REQUIRE(lights.count == 64);
    Vec3 lit = {0, 0, 0}, open = {0, 0, 0};
    for (std::uint32_t i = 0; i < lights.count; ++i) {
      const Vec3& d = lights.light[i].direction;
      if (!(d.y > 0)) continue;
      open += lights.light[i].irradiance * d.y;
      const float reach = (height - 0.001f) / d.y;
      if (std::fabs(d.x * reach) > 1 || std::fabs(d.z * reach) > 1) lit += lights.light[i].irradiance * d.y;
    }
    for (int c = 0; c < 3; ++c)
      CHECK(t->renderer.image[8 * 16 + 8][c] ==
            doctest::Approx(uneven.info.irradiance[0][c] * lit[c] / open[c]).epsilon(1e-4));
  }
}

// Goal: holes and glass let the environment through. Method: a cover of each above a point, against an opaque one.
TEST_CASE("environment_shadow_passes_holes_and_glass") {
  const TestEnvironment even = even_environment({1, 1, 1});
  Material hole = matte(1), veil = matte(1);
  hole.alpha_mode = AlphaMode::mask, hole.opacity = 0.2f, hole.alpha_cutoff = 0.5f;
  veil.alpha_mode = AlphaMode::blend, veil.opacity = 0.2f;
  auto under = [&](const Material& m) {
    Floor floor(1000);
    floor.add_square(1, 50, add_material(&floor, m));
    return seen(&floor, even, with_directions(64)).x;
  };
  CHECK(under(matte(1)) < 0.05f);
  CHECK(under(hole) == 1);
  CHECK(under(veil) == 1);
  CHECK(under(glass(1.5f)) == 1);
}

// Goal: distant lights stand for equal shares of the environment's luminance. Method: sums over them against sums over
// texels, for a vector (the light's first moment) as well as for the total; a bright spot's share of the lights.
TEST_CASE("environment_lights_have_equal_shares") {
  const TestEnvironment uneven = sky();
  Scene scene;
  uneven.give(&scene);
  auto luminance = [](const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
  const std::uint32_t side = uneven.info.side;
  Vec3d moment = {0, 0, 0};
  double total = 0, spot = 0;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const Vec3d p = from_octahedral(2 * (i % side + 0.5) / side - 1, 2 * (i / side + 0.5) / side - 1);
    const double square = dot(p, p), solid_angle = 1 / (square * std::sqrt(square));
    const double flux = luminance(to_double(environment_texel(uneven.texels[i]))) * solid_angle;
    total += flux, moment += normalize(p) * flux;
    if (normalize(p).x > 0.9) spot += flux;
  }
  for (std::uint32_t count : {1u, 16u, 64u, 256u}) {
    CAPTURE(count);
    EnvironmentLights lights;
    place_environment_lights(scene, count, &lights);
    const std::uint32_t all = count * lights.variants;
    REQUIRE(lights.count == all);
    Vec3d sum = {0, 0, 0};
    std::uint32_t in_spot = 0;
    for (std::uint32_t i = 0; i < all; ++i) {
      const EnvironmentLight& light = lights.light[i];
      CHECK(static_cast<double>(length(light.direction)) == doctest::Approx(1).epsilon(1e-6));
      CHECK(luminance(to_double(light.irradiance)) / luminance(to_double(lights.light[0].irradiance)) ==
            doctest::Approx(1).epsilon(0.002));
      sum += to_double(light.direction), in_spot += light.direction.x > 0.9f;
    }
    if (all < 64) continue;
    for (int c = 0; c < 3; ++c) CHECK(sum[c] / all == doctest::Approx(moment[c] / total).epsilon(0.01));
    CHECK(in_spot == doctest::Approx(all * spot / total).epsilon(0.05));
  }
  EnvironmentLights none;
  even_environment({0, 0, 0}).give(&scene);
  const TestEnvironment black = even_environment({0, 0, 0});
  black.give(&scene);
  place_environment_lights(scene, 64, &none);
  CHECK(none.count == 0);
}

// Goal: HARDCASES row 29: no epsilon depends on the scene's size; and the picture does not depend on threads, on the
// accelerator, or on which of its pixels are asked for. Method: a generated scene, by powers of two, threads,
// accelerators, rows, odd spans and single pixels; two samples, and an orthographic camera.
TEST_CASE("environment_shadow_does_not_depend_on_how_a_picture_is_divided") {
  const TestEnvironment uneven = sky();
  for (std::uint32_t variant = 0; variant < 3; ++variant) {
    CAPTURE(variant);
    auto s = generate_scene(kAllFeatures, 7 + variant);
    if (variant == 2) s->cameras[0].projection = Projection::orthographic, s->cameras[0].vertical_extent = 4;
    s->bind();
    uneven.give(&s->scene);
    Settings settings = settings_for(kAllFeatures, 40, 28);
    settings.samples_per_pixel = variant == 1 ? 2 : 1;
    auto t = make_renderer(s->scene, settings);
    REQUIRE(render_frame(&t->renderer, 0).ok);
    REQUIRE(has(t->renderer.effects.mask, Effect::environment_shadow));
    const std::vector<Vec3> whole(t->renderer.image.begin(), t->renderer.image.end());
    const Divisions by(settings.height);
    auto differ = [&](const std::vector<Span>& spans, std::size_t group) {
      return different_pixels(t->renderer, whole, spans, group);
    };
    CHECK(differ(by.rows, 1) == 0);
    CHECK(differ(by.rows, 8) == 0);
    CHECK(differ(by.odd, 5) == 0);
    CHECK(differ(by.pixels, 7) == 0);
    t->renderer.frame.geometry.ray_by_ray = true;
    CHECK(differ(by.rows, 8) == 0);
    settings.threads = 3;
    for (const AccelInfo* info : kAccelList) {
      auto other = make_renderer(s->scene, settings, info);
      REQUIRE(render_frame(&other->renderer, 0).ok);
      CHECK(std::equal(whole.begin(), whole.end(), other->renderer.image.begin()));
    }
  }
  Floor floor, scaled;
  for (Floor* f : {&floor, &scaled}) {
    add_box(f, {-0.5f, 0, -0.5f}, {-0.1f, 0.4f, 0.3f}, 0);
    f->cameras[0].eye = {2, 3, 1}, f->cameras[0].vertical_fov = 0.6f;
  }
  for (Vec3& p : scaled.positions) p = p * 0x1p20f;
  scaled.cameras[0].eye = scaled.cameras[0].eye * 0x1p20f;
  CHECK(seen(&floor, uneven, with_directions(64, 40, 30)) == seen(&scaled, uneven, with_directions(64, 40, 30)));
}
