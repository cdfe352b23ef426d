// A clear coat over a material, layered as KHR_materials_clearcoat has it: a dielectric of index 1.5 over the base.
//   seen = base × (1 − strength × F(n·v)) + strength × coat,  F(x) = 0.04 + 0.96 (1 − x)⁵ [Schlick 1994]
// for the coat's own normal n. A coat of roughness r is partly a mirror, as in metallic_roughness.h, here by Fresnel: k
// F(n·v) with k = max(0, 1 − r/0.3)²; the rest is 1 − k of the GGX lobe of α = r².
#pragma once
#include <cmath>

#include "brdf/brdf_list.h"

namespace pocketray {

constexpr float kCoatReflectance = 0.04f;

template <class T>
T coat_fresnel(T cosine) {
  const T x = 1 - std::fabs(cosine), rise = x > 0 ? x : 0, least = static_cast<T>(kCoatReflectance);
  return least + (1 - least) * (rise * rise * (rise * rise) * rise);
}

// Share k of the mirror.
template <class T>
T coat_mirror_share(T roughness) {
  const T smooth = 1 - roughness / static_cast<T>(0.3);
  return smooth > 0 ? smooth * smooth : 0;
}

// A material that has only the coat's lobe, of strength 1.
inline Material coat_lobe(float roughness) {
  const float rest = 1 - coat_mirror_share(roughness), reflectance = kCoatReflectance * rest;
  Material m;
  m.diffuse = {0, 0, 0}, m.specular = {reflectance, reflectance, reflectance}, m.grazing = rest;
  m.roughness = roughness * roughness, m.brdf = kGgx;
  return m;
}

inline const ClearCoat* coat_of(const Scene& scene, std::uint32_t material) {
  return scene.clear_coats.count && scene.clear_coats[material].strength > 0 ? &scene.clear_coats[material] : nullptr;
}
// Returns whether the coat may have the lobe, or the mirror, somewhere.
inline bool has_lobe(const ClearCoat& coat) { return coat.roughness > 0; }
inline bool has_mirror(const ClearCoat& coat) { return coat_mirror_share(coat.roughness_low) > 0; }

// Upper bounds of the lobe, as for a material: the lobe grows with the roughness, its peak falls.
inline Material coat_bounds(const ClearCoat& coat) {
  Material m = coat_lobe(coat.roughness);
  m.roughness = coat.roughness_low * coat.roughness_low;
  return m;
}

}  // namespace pocketray
