// Distant lights that represent the environment where surfaces shade each other from it: each has an equal share of the
// luminance of all directions, as in [Agarwal et al. 2003, "Structured importance sampling of environment maps"] and
// [Debevec 2005, "A median cut algorithm for light probe sampling"], here by cutting the map along a Hilbert curve.
#pragma once
#include "base/limits.h"
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

struct EnvironmentLight {
  Vec3 direction;   // towards the light, unit
  Vec3 irradiance;  // on a surface facing it, relative to the other lights'
};
struct EnvironmentLights {
  EnvironmentLight light[kEnvironmentLightRoom];  // lights close in direction are close in order
  std::uint32_t count = 0;                        // 0: the environment is black
  std::uint32_t wanted = 0;                       // count that was requested for a point
  std::uint32_t variants = 1;                     // groups of so many lights stand for each of these
};

// True if default lights go with a studio. They cast shadows; the studio's would be faint and double the rays.
inline bool default_lights_cast_shadows(const Scene& scene) {
  return scene.info.default_lights != 0 && scene.lights.count > 0;
}

// True if memory is planned for these lights, even if other settings disable them at first.
inline bool plans_environment_lights(const Scene& scene, const Settings& settings) {
  const EffectMask effects = bit(Effect::environment) | bit(Effect::environment_shadow);
  return scene.environment_info.count > 0 && !default_lights_cast_shadows(scene) && settings.environment_shadows > 0 &&
         !(settings.forced_off & effects) && has(kAllEffects, Effect::environment_shadow);
}

// Places lights for the scene's environment: `count` groups of equal share, at most kEnvironmentLightMax. Points close
// to each other use different lights of a group.
void place_environment_lights(const Scene& scene, std::uint32_t count, EnvironmentLights* lights);

}  // namespace pocketray
