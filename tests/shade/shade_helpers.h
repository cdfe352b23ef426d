// Helpers of the shading suites: surfaces of known radiance and single rays.
#pragma once
#include <cmath>

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

}  // namespace pocketray
