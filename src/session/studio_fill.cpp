#include "session/studio_fill.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/color.h"
#include "base/fmath.h"
#include "plan/plan_scene.h"
#include "plan/room.h"
#include "scene/environment.h"

namespace pocketray {
namespace {

bool shines(const Light& light) { return !is_zero(light.intensity); }

// Luminance of the irradiance on a surface of unit normal; with two sides, on the side that faces the light. Shadow
// rays start at the light, where no surface blocks itself. `size`: of the scene.
double irradiance_from(const Scene& scene, const Light& light, float size, const Vec3& point, const Vec3& normal,
                       bool two_sided) {
  const bool is_distant = light.kind == LightKind::directional;
  const Vec3 from = is_distant ? point - light.direction * (2 * size) : light.position;
  const float distance = length(point - from);
  if (!(distance > 0) || (light.range > 0 && !is_distant && distance > light.range)) return 0;
  const Vec3 direction = (point - from) * (1 / distance);
  const float cosine = two_sided ? std::fabs(dot(normal, direction)) : -dot(normal, direction);
  if (!(cosine > 0)) return 0;
  if (light.kind == LightKind::spot && dot(direction, light.direction) <= light.cos_outer) return 0;
  if (free_distance(scene, from, direction) < 0.999f * distance) return 0;
  const double square = is_distant ? 1 : static_cast<double>(distance) * static_cast<double>(distance);
  return static_cast<double>(luminance(light.intensity)) * static_cast<double>(cosine) / square;
}

}  // namespace

bool calls_for_fill(const Scene& scene) {
  if (scene.environment_info.count || !is_zero(scene.info.ambient)) return false;
  if (std::none_of(scene.lights.begin(), scene.lights.end(), shines)) return false;
  return find_default_view(scene, scene_bounds(scene)).is_room == 0;
}

double typical_radiance(const Scene& scene) {
  const float size = length(extent(scene_bounds(scene)));
  auto area_vector = [&](const Triangle& t) {
    const Vec3& a = scene.positions[t.vertex(0)];
    return cross(scene.positions[t.vertex(1)] - a, scene.positions[t.vertex(2)] - a);
  };
  double area = 0, before = 0, log_sum = 0;
  for (const Triangle& t : scene.triangles) area += static_cast<double>(length(area_vector(t)));
  // Chosen: 64 points, evenly by area, or fewer if there are many lights: at most 512 shadow rays.
  const int count = static_cast<int>(std::clamp<std::uint32_t>(512 / std::max(scene.lights.count, 1u), 4, 64));
  int next = 0, lit = 0;
  for (const Triangle& t : scene.triangles) {
    const Vec3 twice = area_vector(t);
    before += static_cast<double>(length(twice));
    if (is_zero(twice)) continue;
    const Material& m = scene.materials[t.material()];
    for (; next < count && (next + 0.5) / count * area <= before; ++next) {
      const float u = static_cast<float>(next * 13 % 32 + 1) / 66, v = static_cast<float>(next * 7 % 32 + 1) / 66;
      const Vec3 point = scene.positions[t.vertex(0)] * (1 - u - v) + scene.positions[t.vertex(1)] * u +
                         scene.positions[t.vertex(2)] * v;
      double irradiance = 0;
      for (const Light& light : scene.lights)
        irradiance += irradiance_from(scene, light, size, point, normalize(twice), m.double_sided != 0);
      const double radiance = irradiance * static_cast<double>(luminance(m.diffuse + m.specular)) / kPi;
      if (radiance > 0) log_sum += det_log(radiance), ++lit;
    }
  }
  return lit > 0 ? det_exp(log_sum / lit) : 0;
}

void dim_to_fill(double radiance, EnvironmentInfo* studio, Vec3* background) {
  CHECK(studio != nullptr && background != nullptr);
  const double full = static_cast<double>(luminance(studio->irradiance[0]));
  if (!(radiance > 0) || !(full > 0)) return;
  int exponent;
  std::frexp(kFillShare * radiance / full * std::sqrt(2.0), &exponent);
  const float scale = std::clamp(std::ldexp(studio->scale, std::clamp(exponent - 1, -90, 90)), kEnvironmentScaleMin,
                                 kEnvironmentScaleMax),
              factor = scale / studio->scale;
  studio->scale = scale;
  studio->radiance_max = studio->radiance_max * factor;
  for (Vec3& coefficient : studio->irradiance) coefficient = coefficient * factor;
  *background = *background * factor;
}

}  // namespace pocketray
