// Light of the surroundings on glossy lobes: equal from everywhere, times the lobe's albedo. It is the radiosity stored
// at the point (radiosity.h), otherwise ambient light or, where brighter, the background. Without it, metals would be
// black wherever no light shines into their highlight.
#pragma once
#include "brdf/brdf_list.h"
#include "effect/effect.h"
#include "scene/scene.h"

namespace pocketray {

inline Vec3 radiance_of_surroundings(const SceneInfo& info) { return max(info.ambient, info.background); }

// Radiance assumed for paths beyond their maximum depth.
inline Vec3 radiance_beyond_depth(const SceneInfo& info, EffectMask mask) {
  return has(mask, Effect::ambient) ? radiance_of_surroundings(info) : info.background;
}

// Phong's lobe reflects lights only.
inline bool reflects_surroundings(const Material& m) {
  return !is_zero(m.specular) && m.brdf < kBrdfCount && kBrdfList[m.brdf]->albedo;
}

// Radiance to a viewer at a cosine from the normal, of surroundings of a radiance; `specular` as in brdf.h. The material
// must reflect surroundings.
inline Vec3 reflected_surroundings(const Vec3& radiance, const Material& m, const Vec3& specular, float cos_viewer) {
  const BrdfAlbedo albedo = kBrdfList[m.brdf]->albedo(m, specular, cos_viewer);
  return (albedo.once + albedo.scattered) * radiance;
}

// Upper bound of the surroundings' radiance on glossy lobes.
inline Vec3 surroundings_max(const Scene& scene, EffectMask mask) {
  const bool is_stored = has(mask, Effect::radiosity) && scene.radiosity_info.count > 0;
  return is_stored ? scene.radiosity_info[0].value_max : radiance_of_surroundings(scene.info);
}

// Upper bound of reflected_surroundings(), per component.
inline float reflected_surroundings_bound(const Vec3& radiance, const Material& m) {
  if (!reflects_surroundings(m)) return 0;
  float reflectance = max_component(m.specular);
  if (m.grazing > reflectance) reflectance = m.grazing;
  return reflectance * max_component(radiance) * 1.00001f;  // covers rounding
}

}  // namespace pocketray
