#include "plan/effects/census.h"

#include "base/check.h"
#include "base/limits.h"
#include "brdf/clear_coat.h"
#include "indirect/environment.h"
#include "scene/metallic_roughness.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Returns whether a texture of the material's clear coat has a property.
template <class Property>
bool any_of_coat(const Scene& scene, std::uint32_t material, Property property) {
  const ClearCoat* coat = coat_of(scene, material);
  return coat && (property(coat->strength_texture) || property(coat->roughness_texture) || property(coat->normal));
}

bool reads_levels(const Scene& scene, std::uint32_t material) {
  auto has_levels = [&](const TextureUse& use) {
    return use.texture != kNone && scene.textures[use.texture].level_count > 1;
  };
  const Material& m = scene.materials[material];
  if (has_levels(m.diffuse_texture) || has_levels(m.emission_texture)) return true;
  if (scene.grains.count && has_levels(scene.grains[material].texture)) return true;
  if (any_of_coat(scene, material, has_levels)) return true;
  if (scene.material_maps.empty()) return false;
  const MaterialMaps& maps = scene.material_maps[material];
  return has_levels(maps.metallic_roughness) || has_levels(maps.specular) || has_levels(maps.specular_color) ||
         has_levels(maps.normal) || has_levels(maps.occlusion);
}

// Returns whether a texture other than the occlusion texture reads the second texture coordinates.
bool reads_second(const Scene& scene, std::uint32_t material) {
  auto second = [&](const TextureUse& use) { return use.texture != kNone && reads_second_uvs(scene, use); };
  const Material& m = scene.materials[material];
  if (second(m.diffuse_texture) || second(m.emission_texture)) return true;
  if (scene.grains.count && second(scene.grains[material].texture)) return true;
  if (any_of_coat(scene, material, second)) return true;
  if (scene.material_maps.empty()) return false;
  const MaterialMaps& maps = scene.material_maps[material];
  return second(maps.metallic_roughness) || second(maps.specular) || second(maps.specular_color);
}

}  // namespace

Census take_census(const Scene& scene, const Settings& settings) {
  CHECK_LE(scene.materials.count, kMaterialCountMax);
  CHECK(scene.material_maps.empty() || scene.material_maps.count == scene.materials.count);
  bool shows_unlit = !has(settings.forced_off, Effect::emission);
  Census c;
  std::uint32_t used[kMaterialCountMax / 32] = {};
  for (const Triangle& t : scene.triangles) used[t.material() / 32] |= 1u << t.material() % 32;
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    if (!(used[i / 32] >> i % 32 & 1)) continue;
    const Material m =
        scene.material_maps.count ? lobe_bounds(scene.materials[i], scene.material_maps[i]) : scene.materials[i];
    const ClearCoat* coat = coat_of(scene, i);
    const bool shines = coat && has_lobe(*coat);
    bool is_bumpy = coat && coat->normal.texture != kNone;
    if (scene.material_maps.count) {
      const MaterialMaps& maps = scene.material_maps[i];
      c.metallic_roughness += has_lobe_map(maps);
      is_bumpy |= maps.normal.texture != kNone, c.occluded += maps.occlusion.texture != kNone;
    }
    c.bumpy += is_bumpy, c.coated += coat != nullptr;
    c.grained += !is_zero(m.specular) && has_grain(scene, i);
    c.with_levels += reads_levels(scene, i);
    if (reads_second(scene, i))
      ++c.second_uv;
    else if (scene.material_maps.count && scene.material_maps[i].occlusion.texture != kNone)
      c.second_uv_occlusion += reads_second_uvs(scene, scene.material_maps[i].occlusion);
    bool transmits = !is_zero(m.transmission);
    ++c.materials;
    c.specular += !is_zero(m.specular) || shines;
    c.mirror += !is_zero(m.mirror) || (coat && has_mirror(*coat));
    c.transmitting += transmits;
    c.absorbing += transmits && !m.thin && !is_zero(m.absorption);
    c.masked += m.alpha_mode == AlphaMode::mask;
    c.blended += m.alpha_mode == AlphaMode::blend;
    c.emissive += !is_zero(m.emission);
    c.unlit += m.unlit;
    c.textured += m.diffuse_texture.texture != kNone || m.emission_texture.texture != kNone;
    c.reflecting += reflects_surroundings(m) || shines;
    c.diffuse += !(m.unlit && shows_unlit) && !is_zero(m.diffuse);
    c.one_sided += !m.double_sided && !transmits;
    c.scattering += !(m.unlit && shows_unlit) && (!is_zero(m.diffuse) || !is_zero(m.specular) || shines);
  }
  for (const Light& light : scene.lights) ++c.lights[static_cast<int>(light.kind)];
  return c;
}

}  // namespace pocketray
