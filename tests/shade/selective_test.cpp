// Selective rendering: which pixels it traces, and what it may not lose.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "brdf/brdf_list.h"
#include "scene/builtin_helpers.h"
#include "shade/trace_spans.h"
#include "shade_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 34;  // no multiples of a cell's side

Settings selective_settings(float contrast, std::uint32_t width = kWidth, std::uint32_t height = kHeight) {
  Settings settings;
  settings.width = width, settings.height = height;
  settings.cut_off_levels = 0;
  settings.selective_contrast = contrast;
  return settings;
}

struct Rendered {
  Picture picture;
  Tracer counts;
};

Rendered render_with(const Scene& scene, const Settings& settings, double seconds = 0) {
  auto test = make_renderer(scene, settings);
  REQUIRE(render_frame(&test->renderer, seconds).ok);
  return {Picture(test->renderer.image.begin(), test->renderer.image.end()), total_counts(test->renderer)};
}

std::uint64_t ray_count(const Tracer& counts, RayKind kind) { return counts.rays[static_cast<int>(kind)]; }

// A sheet that fills the view, from above, lit by a directional light.
void make_lit_sheet(GeneratedScene* s, std::uint32_t material, const Vec3& light = {0, 0, -1}) {
  add_sheet(s, 0, material);
  s->lights.resize(1);
  s->lights[0].kind = LightKind::directional;
  s->lights[0].direction = normalize(light);
  aim(s, {0, 0, 6}, {0, 0, 0}, 40);
}

float largest_difference(const Picture& a, const Picture& b) {
  REQUIRE(a.size() == b.size());
  float most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c) most = std::fmax(most, std::fabs(a[i][c] - b[i][c]));
  return most;
}

}  // namespace

// Goal: at contrast 0, and with the effect forced on without one, every pixel is traced. Method: differential, bit for
// bit, over generated scenes.
TEST_CASE("selective_of_no_contrast_is_exact") {
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(effort(6)); ++seed) {
    auto generated = generate_scene(kAllFeatures, seed);
    Settings settings = settings_for(kAllFeatures, kWidth, kHeight);
    const Picture expected = render_picture(generated->scene, settings, 0.5);
    settings.forced_on = bit(Effect::selective);
    CAPTURE(seed);
    CHECK(same_picture(render_picture(generated->scene, settings, 0.5), expected));
  }
}

// Goal: of an evenly lit sheet only the cells' corners are traced, and the picture is right. Method: closed form: every
// pixel is albedo / π × irradiance; rays are counted, for sizes at and beside multiples of cells and tiles.
TEST_CASE("selective_traces_the_corners_of_a_plain_surface") {
  for (std::uint32_t width : {1u, 4u, 5u, 32u, 33u, 36u, 37u, 45u}) {
    GeneratedScene s;
    make_lit_sheet(&s, add_material(&s, matte(0.5f)));
    s.bind();
    const std::uint32_t height = width / 2 + 1;
    const Rendered found = render_with(s.scene, selective_settings(0.125f, width, height));
    CAPTURE(width);
    for (const Vec3& pixel : found.picture)
      CHECK(static_cast<double>(pixel.x) == doctest::Approx(0.5 / kPiD).epsilon(1e-5));
    auto corners = [](std::uint32_t side) { return (side + 3) / 4 + ((side - 1) % 4 != 0); };
    CHECK(ray_count(found.counts, RayKind::primary) <= corners(width) * corners(height));
    CHECK(ray_count(found.counts, RayKind::primary) >= (width + 3) / 4 * ((height + 3) / 4));
  }
}

// Goal: light that changes over the picture is interpolated along rows and columns. Method: a point light near a sheet;
// errors stay below the bound of bilinear interpolation, h²/8 times the second derivative, a twentieth of the contrast.
TEST_CASE("selective_interpolates_in_both_directions") {
  GeneratedScene s;
  make_lit_sheet(&s, add_material(&s, matte(0.9f)));
  s.lights[0].kind = LightKind::point;
  s.lights[0].position = {-2, 1.5f, 4}, s.lights[0].intensity = {20, 20, 20};
  s.bind();
  const Rendered exact = render_with(s.scene, selective_settings(0));
  const Rendered found = render_with(s.scene, selective_settings(0.25f));
  CHECK(ray_count(found.counts, RayKind::primary) < exact.picture.size() / 8);
  for (std::size_t i = 0; i < exact.picture.size(); ++i)
    CHECK(double(found.picture[i].x) == doctest::Approx(double(exact.picture[i].x)).epsilon(0.0125));
}

// Goal: an edge is as sharp as traced, wherever it lies, and its pixels take their light from their own side. Method: a
// bright half-plane before a dark one, whose shadow it hides; every pixel shows one or the other, as in the exact
// picture.
TEST_CASE("selective_keeps_edges") {
  for (int i = 0; i < 24; ++i) {
    GeneratedScene s;
    make_lit_sheet(&s, add_material(&s, matte(0.1f)));
    const float edge = -0.5f + 0.018f * static_cast<float>(i);
    const std::uint32_t bright = add_material(&s, matte(0.9f));
    add_quad(&s, {edge, -9, 1}, {9, -9, 1}, {9, 9, 1}, {edge - 0.3f, 9, 1}, bright);
    s.bind();
    const Rendered exact = render_with(s.scene, selective_settings(0));
    const Rendered found = render_with(s.scene, selective_settings(0.125f));
    CAPTURE(i);
    CHECK(largest_difference(found.picture, exact.picture) < 1e-5f);
    CHECK(ray_count(found.counts, RayKind::primary) < ray_count(exact.counts, RayKind::primary) / 2);
    CHECK(ray_count(found.counts, RayKind::shadow) < ray_count(exact.counts, RayKind::shadow) / 4);
  }
}

// Goal: an edge of hardly any contrast is as sharp: a pixel takes no light of another material or another slope.
// Method: two half-planes of almost the same colour, with and without a ridge between them, whose slopes are of one
// material.
TEST_CASE("selective_keeps_faint_edges") {
  for (bool is_ridge : {false, true})
    for (int i = 0; i < 8; ++i) {
      GeneratedScene s;
      const float edge = -0.3f + 0.07f * static_cast<float>(i), depth = is_ridge ? 0.36f * 9 : 0;  // 20 degrees
      const std::uint32_t left = add_material(&s, matte(0.5f));
      const std::uint32_t right = is_ridge ? left : add_material(&s, matte(0.55f));
      add_quad(&s, {edge - 9, -9, -depth}, {edge, -9, 0}, {edge, 9, 0}, {edge - 9, 9, -depth}, left);
      add_quad(&s, {edge, -9, 0}, {edge + 9, -9, -depth}, {edge + 9, 9, -depth}, {edge, 9, 0}, right);
      s.lights.resize(1);
      s.lights[0].kind = LightKind::directional;
      s.lights[0].direction = normalize(is_ridge ? Vec3{-0.08f, 0, -1} : Vec3{0, 0, -1});
      aim(&s, {0, 0, 6}, {0, 0, 0}, 40);
      s.bind();
      const Rendered exact = render_with(s.scene, selective_settings(0));
      const Rendered found = render_with(s.scene, selective_settings(0.125f));
      CAPTURE(is_ridge);
      CAPTURE(i);
      CHECK(largest_difference(found.picture, exact.picture) < 1e-5f);
      CHECK(ray_count(found.counts, RayKind::primary) < ray_count(exact.counts, RayKind::primary) / 2);
    }
}

// Goal: textures keep every texel. Method: a checkerboard finer than the cells under even light: the exact picture,
// though most of its pixels trace no shadow ray; a black texel tells nothing of its neighbours' light.
TEST_CASE("selective_keeps_textures") {
  GeneratedScene s;
  std::vector<std::array<int, 4>> texels;
  for (int i = 0; i < 64 * 64; ++i) texels.push_back({(i + i / 64) % 2 ? 255 : 140, 200, i % 3 * 100 + 50, 255});
  Material m = matte(0.8f);
  m.diffuse_texture.texture = add_texture(&s, 64, 64, texels);
  s.with_uvs = true;
  make_lit_sheet(&s, add_material(&s, m), {-1, -2, -3});
  s.bind();
  Settings every = selective_settings(0), some = selective_settings(0.125f);
  every.forced_on = some.forced_on = bit(Effect::shadow);  // nothing can block the light
  const Rendered exact = render_with(s.scene, every);
  const Rendered found = render_with(s.scene, some);
  CHECK(largest_difference(found.picture, exact.picture) < 1e-5f);
  CHECK(ray_count(found.counts, RayKind::primary) >= kWidth * kHeight);
  CHECK(ray_count(found.counts, RayKind::shadow) < ray_count(exact.counts, RayKind::shadow) / 2);
}

// Goal: a texture that turns a grain keeps every texel, too: no pixel of it is interpolated. Method: stripes of two
// grains.
TEST_CASE("selective_keeps_the_texture_of_a_grain") {
  GeneratedScene s;
  std::vector<std::array<int, 4>> texels;
  for (int i = 0; i < 64 * 64; ++i) texels.push_back({i % 2 ? 255 : 128, i % 2 ? 128 : 255, 255, 255});
  Material m = matte(0.2f);
  m.brdf = kGgx, m.roughness = 0.2f, m.specular = {0.6f, 0.6f, 0.6f};
  const std::uint32_t material = add_material(&s, m);
  s.grains.resize(material + 1);
  s.grains[material].direction = {0.9f, 0};
  s.grains[material].texture.texture = add_texture(&s, 64, 64, texels);
  s.with_uvs = true;
  make_lit_sheet(&s, material, {-0.3f, -0.2f, -1});
  s.bind();
  const Rendered exact = render_with(s.scene, selective_settings(0));
  const Rendered found = render_with(s.scene, selective_settings(0.125f));
  CHECK(ray_count(found.counts, RayKind::primary) >= kWidth * kHeight);
  CHECK(largest_difference(found.picture, exact.picture) < 1e-5f);
}

// Goal: what a mirror or a glass shows is traced, not guessed. Method: a mirror that fills the view, opposite a
// pattern: bit for bit.
TEST_CASE("selective_traces_mirrors_and_glass") {
  for (bool is_glass : {false, true}) {
    GeneratedScene s;
    Material m = is_glass ? glass(1.5f) : matte(0);
    if (!is_glass) m.mirror = {0.9f, 0.9f, 0.9f};
    m.thin = is_glass;
    make_lit_sheet(&s, add_material(&s, m));
    for (int i = -6; i < 6; ++i)
      add_box(&s, {0.5f * i, -9, is_glass ? -3.0f : 8}, {0.5f * i + 0.2f, 9, is_glass ? -2.0f : 9},
              add_material(&s, unlit(1)));
    s.bind();
    const Rendered exact = render_with(s.scene, selective_settings(0));
    const Rendered found = render_with(s.scene, selective_settings(0.5f));
    CAPTURE(is_glass);
    CHECK(same_picture(found.picture, exact.picture));
  }
}

// Goal: a face that rays pass is not the surface that is seen. Method: a faint pattern behind the back of a one-sided
// sheet, and within a body that absorbs: bit for bit.
TEST_CASE("selective_looks_through_backs_and_bodies") {
  for (bool in_body : {false, true}) {
    GeneratedScene s;
    const std::uint32_t ground = add_material(&s, unlit(0.5f));
    make_lit_sheet(&s, ground);
    for (int i = -8; i < 8; ++i) {
      const float x = 0.4f * static_cast<float>(i);
      add_quad(&s, {x, -9, 0.1f}, {x + 0.1f, -9, 0.1f}, {x + 0.1f, 9, 0.1f}, {x, 9, 0.1f},
               add_material(&s, unlit(0.54f)));
    }
    Material cover = matte(0.5f);
    cover.double_sided = false;
    if (in_body)
      add_box(&s, {-8, -8, -1}, {8, 8, 9}, add_material(&s, glass(1, {1, 1, 1}, {0.05f, 0.1f, 0.2f})));
    else
      add_sheet(&s, 1, add_material(&s, cover), true);
    s.bind();
    const Rendered exact = render_with(s.scene, selective_settings(0));
    CAPTURE(in_body);
    CHECK(exact.picture[0].x > 0);
    CHECK(same_picture(render_with(s.scene, selective_settings(0.125f)).picture, exact.picture));
  }
}

// Goal: the larger the contrast, the fewer rays; errors stay small on the average. Method: the built-in scenes.
TEST_CASE("selective_trades_rays_for_error") {
  for (const char* name : {"cornell", "seesaw", "statue"}) {
    auto built = build_builtin(name);
    const std::uint32_t side = effort_side(240);
    const Rendered exact = render_with(built->scene, selective_settings(0, side * 4 / 3, side));
    std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
    for (float contrast : {0.0625f, 0.125f, 0.25f, 0.5f}) {
      const Rendered found = render_with(built->scene, selective_settings(contrast, side * 4 / 3, side));
      const std::uint64_t rays = ray_count(found.counts, RayKind::shadow);
      double sum = 0;
      for (std::size_t i = 0; i < found.picture.size(); ++i)
        for (int c = 0; c < 3; ++c)
          sum += std::fabs(double(std::fmin(found.picture[i][c], 1)) - double(std::fmin(exact.picture[i][c], 1)));
      const double error = sum / (3.0 * static_cast<double>(found.picture.size()));
      CAPTURE(std::string(name));
      CAPTURE(contrast);
      CHECK(rays < last);
      CHECK(error < 0.03 * double(contrast) + 0.001);
      CHECK(error > 0);
      last = rays;
    }
    if (side == 240) CHECK(last < ray_count(exact.counts, RayKind::shadow) / 3);
  }
}

// Goal: several samples a pixel are interpolated and traced likewise; orthographic cameras too. Method: invariant: even
// light stays even, and fewer rays are traced; exact at contrast 0.
TEST_CASE("selective_takes_samples_and_orthographic_cameras") {
  for (std::uint32_t samples : {1u, 4u})
    for (Projection projection : {Projection::perspective, Projection::orthographic}) {
      GeneratedScene s;
      make_lit_sheet(&s, add_material(&s, matte(0.1f)));
      add_quad(&s, {-9, -9, 1}, {0.3f, -9, 1}, {0.1f, 9, 1}, {-9, 9, 1}, add_material(&s, matte(0.9f)));
      s.cameras[0].projection = projection, s.cameras[0].vertical_extent = 4;
      s.bind();
      Settings settings = selective_settings(0);
      settings.samples_per_pixel = samples;
      const Rendered exact = render_with(s.scene, settings);
      settings.selective_contrast = 0.125f;
      const Rendered found = render_with(s.scene, settings);
      CAPTURE(samples);
      CHECK(largest_difference(found.picture, exact.picture) < 1e-5f);
      CHECK(ray_count(found.counts, RayKind::primary) < ray_count(exact.counts, RayKind::primary) * 3 / 4);
    }
}

// Goal: radiances beyond the display's range make no other pixel wrong. Method: an emitter of 10³⁰ beside a dark sheet.
TEST_CASE("hard_58_selective_with_huge_radiance") {
  GeneratedScene s;
  make_lit_sheet(&s, add_material(&s, matte(0.5f)));
  Material sun = matte(0);
  sun.emission = {1e30f, 1e30f, 0};
  add_quad(&s, {0.1f, -1, 1}, {1, -1, 1}, {1, 1, 1}, {0.1f, 1, 1}, add_material(&s, sun));
  s.bind();
  Settings settings = selective_settings(0.5f);
  settings.forced_off = bit(Effect::area_light);
  const Rendered found = render_with(s.scene, settings);
  settings.selective_contrast = 0;
  const Rendered exact = render_with(s.scene, settings);
  for (std::size_t i = 0; i < found.picture.size(); ++i) {
    CHECK(std::isfinite(found.picture[i].x));
    CHECK((found.picture[i].x > 1) == (exact.picture[i].x > 1));
  }
}
