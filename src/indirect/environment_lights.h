// Distant lights that stand for the environment where surfaces shade each other from it: each has an equal share of the
// luminance of all directions, as in [Agarwal et al. 2003, "Structured importance sampling of environment maps"] and
// [Debevec 2005, "A median cut algorithm for light probe sampling"], here by cutting the map along a Hilbert curve.
#pragma once
#include "base/limits.h"
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

struct EnvironmentLight {
  Vec3 direction;   // towards it, unit
  Vec3 irradiance;  // on a surface that faces it, in units of its own: one light's relative to another's
};
struct EnvironmentLights {
  EnvironmentLight light[kEnvironmentLightMax];  // close ones next to each other
  std::uint32_t count = 0;                       // 0: the environment is black
  std::uint32_t wanted = 0;                      // the count that they were placed for
};

// Whether default lights stand before a studio. They cast shadows; its own would be faint and take as many rays again.
inline bool default_lights_cast_shadows(const Scene& scene) {
  return scene.info.default_lights != 0 && scene.lights.count > 0;
}

// Whether memory is planned for them, even if other settings leave them out at first.
inline bool plans_environment_lights(const Scene& scene, const Settings& settings) {
  const EffectMask effects = bit(Effect::environment) | bit(Effect::environment_shadow);
  return scene.environment_info.count > 0 && !default_lights_cast_shadows(scene) && settings.environment_shadows > 0 &&
         !(settings.forced_off & effects) && has(kAllEffects, Effect::environment_shadow);
}

// Places `count` lights for the scene's environment, at most kEnvironmentLightMax.
void place_environment_lights(const Scene& scene, std::uint32_t count, EnvironmentLights* lights);

}  // namespace pocketray
