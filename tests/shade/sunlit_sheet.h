// A sheet under a sun, for materials with layers.
#pragma once
#include "shade_helpers.h"

namespace pocketray {

inline const Vec3 kPoint = {0.1f, 0.2f, 0};
inline const Vec3 kSun = {0.3f, 0.5f, 1};

inline Material plastic() {
  Material m;
  m.diffuse = {0.5f, 0.4f, 0.3f}, m.specular = {0.05f, 0.06f, 0.07f}, m.grazing = 1;
  m.brdf = kGgx, m.roughness = 0.4f;
  return m;
}

// A double-sided sheet in the plane z = 0 under a sun, its coordinates u along x and v along y.
struct SunlitSheet {
  GeneratedScene scene;
  SunlitSheet(const Material& base, bool lit) {
    add_sheet(&scene, 0, add_material(&scene, base), false, 10);
    scene.with_uvs = true;
    scene.lights.resize(1);
    scene.lights[0].kind = LightKind::directional;
    scene.lights[0].direction = -normalize(kSun);
    if (!lit) scene.lights[0].intensity = {0, 0, 0};
  }
  std::uint32_t texture(int r, int g, int b, int a = 255) { return add_texture(&scene, 1, 1, {{r, g, b, a}}); }
  // A ceiling far above that shows a radiance; half of one lets the sun through.
  void add_ceiling_to_sheet(float radiance, bool half = false) {
    const float right = half ? 0 : 400;
    add_quad(&scene, {-400, 400, 40}, {right, 400, 40}, {right, -400, 40}, {-400, -400, 40},
             add_material(&scene, unlit(radiance)));
  }
};

// Radiance of the sheet's point.
inline Vec3 seen(GeneratedScene* s, const Vec3& eye) {
  auto t = ray_renderer(s);
  return look(*t, eye, kPoint);
}

inline void check_near(const Vec3& found, const Vec3d& expected, double tolerance = 2e-4) {
  for (int c = 0; c < 3; ++c) CHECK(static_cast<double>(found[c]) == doctest::Approx(expected[c]).epsilon(tolerance));
}

}  // namespace pocketray
