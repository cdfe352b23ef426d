#include "indirect/instant_radiosity.h"

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {

Vec3 virtual_irradiance(const VirtualLights& lights, float geometry_max, const Vec3& point, const Vec3& normal) {
  CHECK_LE(lights.count, kVirtualLightRoom);
  Vec3 sum = {0, 0, 0}, to_light;
  for (std::uint32_t i = 0; i < lights.count; ++i)
    sum += virtual_irradiance(lights.light[i], geometry_max, point, normal, &to_light);
  return sum;
}

IndirectUse InstantRadiosity::use(const Scene& scene) {
  bool shines = scene.lights.count > 0, scatters = false;
  for (const Material& m : scene.materials) {
    shines = shines || !is_zero(m.emission);
    scatters = scatters || (!m.unlit && !is_zero(m.diffuse));
  }
  return shines && scatters ? IndirectUse::requested : IndirectUse::nothing;
}

const void* InstantRadiosity::prepare(const Scene&, const Quality&, Arena* keep, Arena*) {
  VirtualLights* lights = arena_array<VirtualLights>(keep, 1).data;
  *lights = VirtualLights();
  return lights;
}

Vec3 InstantRadiosity::radiance(const IndirectPoint& at) {
  effect_entered<Effect::instant_radiosity>();
  CHECK(at.prepared != nullptr);
  if (is_zero(at.diffuse)) return {0, 0, 0};
  const VirtualLights& lights = *static_cast<const VirtualLights*>(at.prepared);
  return at.diffuse * (virtual_irradiance(lights, lights.geometry_max, at.point, at.normal) * (1 / kPiF));
}

}  // namespace pocketray
