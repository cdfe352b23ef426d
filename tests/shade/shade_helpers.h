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

}  // namespace pocketray
