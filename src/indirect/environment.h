// Light from a stored environment: radiance for rays that hit nothing, and its reflection by diffuse and glossy
// surfaces. It is unshadowed here: at first hits, shade/environment_shadow.cpp adds the diffuse part with shadows.
// Mirrors and glass see the environment behind what they hit.
#pragma once
#include <cmath>

#include "brdf/microfacet.h"
#include "effect/settings.h"
#include "indirect/surroundings.h"

namespace pocketray {

// Returns the scene's environment, or null.
inline const EnvironmentInfo* environment_of(const Scene& scene) {
  return scene.environment_info.count ? scene.environment_info.data : nullptr;
}

// Bilinear interpolation between the four nearest texels of a map.
inline Vec3 environment_map_at(const std::uint32_t* texels, std::uint32_t side_count, const Vec3& direction) {
  const int side = static_cast<int>(side_count);
  float u, v;
  to_octahedral(direction, &u, &v);
  auto place = [side](float at, int* index) {  // index of the texel before it, in [−1, side − 1], and the fraction
    at = (at + 1) * (0.5f * static_cast<float>(side)) + 0.5f;
    const float end = static_cast<float>(side) + 0.5f;
    at = at > 0 ? at < end ? at : end : 0;
    *index = static_cast<int>(at) - 1;
    return at - static_cast<float>(*index + 1);
  };
  int column, row;
  const float s = place(u, &column), t = place(v, &row);
  auto texel = [&](int i, int j) { return environment_texel(texels[octahedral_index(column + i, row + j, side)]); };
  auto mix = [](const Vec3& a, const Vec3& b, float share) { return a * (1 - share) + b * share; };
  return mix(mix(texel(0, 0), texel(1, 0), s), mix(texel(0, 1), texel(1, 1), s), t);
}

// Radiance from a direction, which need not be a unit vector.
inline Vec3 environment_radiance(const Scene& scene, const Vec3& direction) {
  const EnvironmentInfo& info = scene.environment_info[0];
  return environment_map_at(scene.environment_texels.data, info.side, direction) * info.scale;
}

// Mean radiance over the GGX lobe of roughness α around a direction, for a viewer along the normal.
inline Vec3 environment_gloss(const Scene& scene, const Vec3& direction, float alpha) {
  const EnvironmentInfo& info = scene.environment_info[0];
  const float roughness = std::sqrt(alpha);
  int level = 0;
  while (level < kGlossLevelCount - 2 && roughness > kGlossRoughness[level + 1]) ++level;
  const float share = (roughness - kGlossRoughness[level]) / (kGlossRoughness[level + 1] - kGlossRoughness[level]);
  auto at = [&](int l) {
    const std::uint32_t* texels = scene.environment_texels.data + gloss_level_begin(info.side, info.gloss_side, l);
    return environment_map_at(texels, gloss_level_side(info.gloss_side, l), direction) * info.scale;
  };
  if (!(share > 0)) return at(level);
  if (share >= 1) return at(level + 1);
  return at(level) * (1 - share) + at(level + 1) * share;
}

// Irradiance / π on a surface of unit normal.
template <class T>
inline Vec3T<T> environment_irradiance(const EnvironmentInfo& info, const Vec3T<T>& n) {
  const T basis[9] = {1, n.x, n.y, n.z, n.x * n.y, n.y * n.z, n.x * n.z, n.x * n.x - n.z * n.z, 3 * n.y * n.y - 1};
  Vec3T<T> sum = {0, 0, 0};
  for (int i = 0; i < 9; ++i)
    for (int c = 0; c < 3; ++c) sum[c] += static_cast<T>(info.irradiance[i][c]) * basis[i];
  // Nine coefficients ring: opposite a bright light they fall below zero.
  for (int c = 0; c < 3; ++c) {
    const T most = static_cast<T>(info.radiance_max[c]);
    sum[c] = sum[c] > 0 ? sum[c] < most ? sum[c] : most : 0;
  }
  return sum;
}

// Mean radiance over a GGX lobe around the mirrored direction. `way` goes from the viewer to the surface.
inline Vec3 environment_in_lobe(const Scene& scene, const Vec3& normal, const Vec3& way, float alpha) {
  const float smoothness = 1 - alpha;
  // Off the normal, the middle of a rough lobe is nearer to the normal than the mirrored direction [Lagarde & de
  // Rousiers 2014, "Moving Frostbite to PBR", listing 22].
  const float share = smoothness * (std::sqrt(smoothness) + alpha);
  const Vec3 mirrored = way - normal * (2 * dot(normal, way));
  return environment_gloss(scene, normal * (1 - share) + mirrored * share, alpha);
}

// environment_in_lobe() for a lobe with a grain: the mean around microfacets that lean along the grain, at the middles
// of four equal shares of their slopes, which are distributed as 1/(1 + (x/αx)²)^(3/2); weighted by the cosine of the
// mirrored direction, like the map's levels. Glossy lobes without a grain do not call it.
inline Vec3 environment_along_grain(const Scene& scene, const LobeFrame& frame, const Vec3& way, float alpha) {
  const GrainAxes<float> axes = grain_axes(frame, alpha);
  Vec3 sum = {0, 0, 0};
  float weights = 0;
  for (float slope : {-1.1338934f, -0.25819889f, 0.25819889f, 1.1338934f}) {
    const Vec3 facet = normalize(frame.normal + axes.tangent * (slope * axes.along));
    const float cosine = dot(frame.normal, way - facet * (2 * dot(facet, way)));
    if (!(cosine > 0) || !(dot(facet, way) < 0)) continue;
    sum += environment_in_lobe(scene, facet, way, alpha) * cosine;
    weights += cosine;
  }
  return weights > 0 ? sum / weights : environment_in_lobe(scene, frame.normal, way, alpha);
}

// Radiance to a viewer from a glossy lobe under the environment: the split sum [Karis 2013]. `specular` as in brdf.h;
// the material must reflect its surroundings. `way` goes from the viewer to the surface, `irradiance` is
// environment_irradiance() there.
inline Vec3 reflected_environment(const Scene& scene, const Material& m, const Vec3& specular, const Vec3& normal,
                                  const Vec3& way, const Vec3& irradiance) {
  const BrdfAlbedo albedo = kBrdfList[m.brdf]->albedo(m, specular, dot(normal, way));
  return albedo.once * environment_in_lobe(scene, normal, way, m.roughness) + albedo.scattered * irradiance;
}
// reflected_environment() for a lobe with a grain; its albedo is that of the isotropic lobe of equal area.
inline Vec3 reflected_along_grain(const Scene& scene, const Material& m, const Vec3& specular, const LobeFrame& frame,
                                  const Vec3& way, const Vec3& irradiance) {
  const BrdfAlbedo albedo = kBrdfList[m.brdf]->albedo(evened(m, frame), specular, dot(frame.normal, way));
  return albedo.once * environment_along_grain(scene, frame, way, m.roughness) + albedo.scattered * irradiance;
}

// Returns whether the environment lights surfaces, besides being visible. Stored radiosity contains its diffuse part.
inline bool environment_lights(const Scene& scene, EffectMask mask, IndirectChoice indirect) {
  return has(mask, Effect::environment) && environment_of(scene) && indirect != IndirectChoice::none;
}
inline bool environment_lights_diffuse(EffectMask mask) { return !has(mask, Effect::radiosity); }

// Upper bound of the environment's radiance reflected by a material, per component.
inline float environment_bound(const Scene& scene, const Material& m, EffectMask mask) {
  const Vec3& most = scene.environment_info[0].radiance_max;
  float bound = environment_lights_diffuse(mask) ? max_component(m.diffuse * most) : 0;
  if (reflects_surroundings(m)) {
    float reflectance = max_component(m.specular);
    if (m.grazing > reflectance) reflectance = m.grazing;
    bound += reflectance * max_component(most) * 1.00001f;  // covers rounding
  }
  return bound;
}

}  // namespace pocketray
