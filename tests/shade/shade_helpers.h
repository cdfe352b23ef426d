// Helpers of the shading suites: surfaces of known radiance and single rays.
#pragma once
#include <cmath>

#include <doctest/doctest.h>

#include "shade/filters.h"
#include "shade/trace_spans.h"
#include "support/generated_scene.h"

namespace pocketray {

constexpr double kPiD = 3.14159265358979323846;

inline Material unlit(float radiance) {
  Material m;
  m.diffuse = {radiance, radiance / 2, radiance / 4};
  m.unlit = 1;
  return m;
}
inline Material matte(float albedo) {
  Material m;
  m.diffuse = {albedo, albedo, albedo};
  return m;
}
inline Material glass(float ior, const Vec3& tint = {1, 1, 1}, const Vec3& absorption = {0, 0, 0}) {
  Material m;
  m.diffuse = {0, 0, 0};
  m.transmission = tint;
  m.ior = ior;
  m.absorption = absorption;
  return m;
}
// A large square at height z that faces +z, or −z with `down`.
inline void add_sheet(GeneratedScene* s, float z, std::uint32_t material, bool down = false, float side = 10) {
  if (down)
    add_quad(s, {-side, side, z}, {side, side, z}, {side, -side, z}, {-side, -side, z}, material);
  else
    add_quad(s, {-side, -side, z}, {side, -side, z}, {side, side, z}, {-side, side, z}, material);
}

// A renderer that skips nothing; one pixel, for single rays.
inline std::unique_ptr<TestRenderer> ray_renderer(GeneratedScene* s, std::uint32_t depth = 16,
                                                  std::uint32_t area_points = 256) {
  if (s->cameras.empty()) aim(s, {0.1f, 0.2f, 50}, {0, 0, 0}, 40);
  if (s->lights.empty()) {  // a dark one, to avoid default lights
    s->lights.resize(1);
    s->lights[0].intensity = {0, 0, 0};
  }
  s->bind();
  Settings settings;
  settings.width = settings.height = 1;
  settings.ray_depth = depth;
  settings.points_per_area_light = area_points;
  settings.cut_off_levels = 0;
  return make_renderer(s->scene, settings);
}
inline Vec3 look(const TestRenderer& t, const Vec3& from, const Vec3& to) {
  return trace_ray(t.renderer, from, normalize(to - from));
}

// A frame's picture traced by one thread, in tiles or ray by ray.
struct TracedPicture {
  Picture picture;
  std::uint64_t shadow_rays = 0;
};
inline TracedPicture trace_picture(const Scene& scene, const Settings& settings, const AccelInfo* accel = nullptr,
                                   bool in_tiles = true) {
  auto test = make_renderer(scene, settings, accel);
  REQUIRE(render_frame(&test->renderer, 0).ok);
  FrameData frame = test->renderer.frame;
  make_filters(&frame);
  if (!in_tiles) frame.kernels.find_shadows = nullptr;
  std::vector<Span> spans;
  for (std::uint32_t row = 0; row < settings.height; ++row)
    spans.push_back({static_cast<std::uint16_t>(row), 0, static_cast<std::uint16_t>(settings.width)});
  Tracer tracer = make_tracer(frame);
  TracedPicture traced;
  traced.picture.resize(std::size_t(settings.width) * settings.height);
  trace_spans(&tracer, spans.data(), static_cast<std::uint32_t>(spans.size()), Aov::none, traced.picture.data());
  traced.shadow_rays = tracer.rays[static_cast<int>(RayKind::shadow)];
  return traced;
}

// Matte, black and other surfaces side by side, with a box on them, below lamps near and far.
inline void add_three_below_lamps(const Material& other, GeneratedScene* s) {
  const std::uint32_t materials[] = {add_material(s, matte(0.6f)), add_material(s, matte(0)), add_material(s, other)};
  for (int i = 0; i < 3; ++i) {
    const float x = static_cast<float>(2 * i - 3);
    add_quad(s, {x, -1, 0}, {x + 2, -1, 0}, {x + 2, 1, 0}, {x, 1, 0}, materials[i]);
  }
  Material lamp = matte(0);
  lamp.emission = {6, 5, 4};
  const std::uint32_t lamps = add_material(s, lamp);
  add_quad(s, {-2, 1.2f, 0.5f}, {2, 1.2f, 0.5f}, {2, 1.2f, 1.5f}, {-2, 1.2f, 1.5f}, lamps);
  add_box(s, {-0.4f, -0.2f, 0.2f}, {0.4f, 0.1f, 0.5f}, materials[2]);
  aim(s, {0.3f, -3, 3}, {0, 0, 0}, 40);
}

// Compares bits of tiles with those of single rays, without and with many small lights, and a selection of lights that
// may err by nothing with all of them.
inline void check_lit_alike_by_all_ways(GeneratedScene* s) {
  for (int many = 0; many < 2; ++many) {
    for (int i = 0; i < 24 * many; ++i) {
      s->lights.emplace_back();
      s->lights.back().position = {0.3f * static_cast<float>(i) - 4, 0.1f * static_cast<float>(i % 5) - 2, 2};
      s->lights.back().intensity = {0.3f, 0.2f, 0.1f};
    }
    s->bind();
    Settings settings;
    settings.width = 48, settings.height = 32, settings.light_tolerance = 0, settings.points_per_area_light = 4;
    settings.cut_off_levels = 0;
    const Picture tiles = trace_picture(s->scene, settings).picture;
    CHECK(same_picture(tiles, trace_picture(s->scene, settings, nullptr, false).picture));
    if (!many) continue;
    settings.area_irradiance = AreaIrradiance::points;
    const Picture all = render_picture(s->scene, settings);
    settings.light_tolerance = 1e-6f;
    const Picture selected = render_picture(s->scene, settings);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (int c = 0; c < 3; ++c) CHECK(selected[i][c] == doctest::Approx(all[i][c]).epsilon(1e-3));
  }
}

}  // namespace pocketray
