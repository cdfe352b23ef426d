// glTF's metallic-roughness model (secs. 3.9, B.2.2) as lobes of a material, for base colour c, metallic m, roughness
// r, a dielectric's reflectance d at normal and g at grazing incidence, and transmission t:
//   F0 = lerp(d, c, m), F90 = lerp(g, 1, m)
//   k = max(0, 1 − r/0.3)²                     how much of F0 is a perfect mirror: all at r = 0, none from r = 0.3
//   mirror = F0·k                              c·m·k of it is tinted by texture and vertex colour
//   specular = F0·(1 − k), grazing = F90·(1 − k)   the GGX lobe of α = r² (sec. B.3); c·m·(1 − k) is tinted
//   t' = t·(1 − m)                             glass; Fresnel gives it its mirror: mirror × (1 − t')
//   transmission = c·t', diffuse = c·(1 − m)·(1 − t)
#pragma once
#include <cmath>

#include "scene/scene.h"

namespace pocketray {

// k for a roughness r² = α of a material.
inline float mirror_share(float alpha) {
  const float k = 1 - std::sqrt(alpha) / 0.3f;
  return k > 0 ? k * k : 0;
}

// Sets diffuse, specular, mirror, their tinted parts, transmission, roughness and grazing.
inline void set_lobes(const MetallicRoughness& model, float metallic, float roughness, float transmission,
                      Material* m) {
  const Vec3 metal = model.base * metallic, f0 = model.dielectric * (1 - metallic) + metal;
  const float passes = transmission * (1 - metallic);
  float k = 1 - roughness / 0.3f;
  k = k > 0 ? k * k : 0;
  m->diffuse = model.base * ((1 - metallic) * (1 - transmission));
  m->mirror = f0 * (k * (1 - passes));
  m->mirror_tinted = metal * (k * (1 - passes));
  m->specular = f0 * (1 - k);
  m->specular_tinted = metal * (1 - k);
  m->roughness = roughness * roughness;
  m->grazing = (model.grazing * (1 - metallic) + metallic) * (1 - k);
  m->transmission = model.base * passes;
}

// Returns whether the lobes change from point to point.
inline bool has_lobe_map(const MaterialMaps& maps) {
  return maps.metallic_roughness.texture != kNone || maps.specular.texture != kNone ||
         maps.specular_color.texture != kNone;
}
inline bool has_map(const MaterialMaps& maps) {
  return has_lobe_map(maps) || maps.normal.texture != kNone || maps.occlusion.texture != kNone;
}

// Returns the material's textures of transmitted light, or null.
inline const GlassMap* glass_map_of(const Scene& scene, std::uint32_t material) {
  return scene.glass_maps.count && scene.glass_maps[material].transmission > 0 ? &scene.glass_maps[material] : nullptr;
}

// Upper bounds of the material's lobes under its maps, and the smallest roughness: all are monotonic in metallic,
// roughness and transmission, so that their extremes are at the ends of the ranges. A specular texture only dims.
// `glass` may be null.
inline Material lobe_bounds(Material m, const MaterialMaps& maps, const GlassMap* glass) {
  if (!has_lobe_map(maps) && !glass) return m;
  const float most = glass ? glass->transmission : 0;
  const float least = glass && glass->transmission_texture.texture == kNone ? most : 0;
  set_lobes(maps.model, maps.metallic_low, maps.roughness_low, least, &m);
  for (int i = 1; i < (glass ? 8 : 4); ++i) {
    Material end = m;
    set_lobes(maps.model, i & 1 ? maps.metallic_high : maps.metallic_low,
              i & 2 ? maps.roughness_high : maps.roughness_low, i & 4 ? most : least, &end);
    m.diffuse = max(m.diffuse, end.diffuse), m.transmission = max(m.transmission, end.transmission);
    m.specular = max(m.specular, end.specular), m.specular_tinted = max(m.specular_tinted, end.specular_tinted);
    m.mirror = max(m.mirror, end.mirror), m.mirror_tinted = max(m.mirror_tinted, end.mirror_tinted);
    if (end.roughness < m.roughness) m.roughness = end.roughness;
    if (end.grazing > m.grazing) m.grazing = end.grazing;
  }
  return m;
}

inline Material lobe_bounds(const Scene& scene, std::uint32_t material) {
  const Material& m = scene.materials[material];
  return scene.material_maps.count ? lobe_bounds(m, scene.material_maps[material], glass_map_of(scene, material)) : m;
}

}  // namespace pocketray
