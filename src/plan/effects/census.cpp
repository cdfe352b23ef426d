#include "plan/effects/census.h"

#include "base/check.h"
#include "base/limits.h"
#include "brdf/clear_coat.h"
#include "brdf/iridescence.h"
#include "brdf/rough_refraction.h"
#include "brdf/sheen.h"
#include "indirect/environment.h"
#include "scene/channel.h"
#include "scene/diffuse_transmission.h"
#include "scene/invisible.h"
#include "scene/metallic_roughness.h"
#include "scene/triangle_scan.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Returns whether a texture of the material's clear coat, sheen, film or glass has a property.
template <class Property>
bool any_of_layers(const Scene& scene, std::uint32_t material, Property property) {
  const ClearCoat* coat = coat_of(scene, material);
  const Sheen* sheen = sheen_of(scene, material);
  const Iridescence* film = iridescence_of(scene, material);
  const GlassMap* glass = glass_map_of(scene, material);
  const DiffuseTransmission* passing = diffuse_transmission_of(scene, material);
  return (coat && (property(coat->strength_texture) || property(coat->roughness_texture) || property(coat->normal))) ||
         (sheen && (property(sheen->color_texture) || property(sheen->roughness_texture))) ||
         (passing && (property(passing->strength_texture) || property(passing->color_texture))) ||
         (film && (property(film->strength_texture) || property(film->thickness_texture))) ||
         (glass && (property(glass->transmission_texture) || property(glass->thickness_texture)));
}

bool reads_levels(const Scene& scene, std::uint32_t material) {
  auto has_levels = [&](const TextureUse& use) {
    return use.texture != kNone && scene.textures[use.texture].level_count > 1;
  };
  const Material& m = scene.materials[material];
  if (has_levels(m.diffuse_texture) || has_levels(m.emission_texture)) return true;
  if (scene.grains.count && has_levels(scene.grains[material].texture)) return true;
  if (any_of_layers(scene, material, has_levels)) return true;
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
  if (any_of_layers(scene, material, second)) return true;
  if (scene.material_maps.empty()) return false;
  const MaterialMaps& maps = scene.material_maps[material];
  return second(maps.metallic_roughness) || second(maps.specular) || second(maps.specular_color);
}

void note(Census* census, Invisible what, std::uint32_t count) {
  CHECK_LT(static_cast<int>(what), kInvisibleCount);
  census->invisible[static_cast<int>(what)] += count;
}

// Returns whether a triangle can be hit: resting ones without area cannot.
bool has_area(const Scene& scene, const Triangle& t) {
  const Vec3d a = to_double(scene.positions[t.vertex(0)]);
  return scene.moving_meshes.count > 0 ||
         !is_zero(cross(to_double(scene.positions[t.vertex(1)]) - a, to_double(scene.positions[t.vertex(2)]) - a));
}

bool is_driven(const Scene& scene, std::uint32_t light) {
  for (const Channel& channel : scene.channels)
    if (channel.node == light &&
        (channel.path == ChannelPath::light_intensity || channel.path == ChannelPath::light_scale))
      return true;
  return false;
}

// Counts the lights that reach something now or may do so in another frame.
void count_lights(const Scene& scene, Census* c) {
  bool has_range = false;
  for (const Light& light : scene.lights) has_range |= light.range > 0;
  const Box bounds = has_range ? triangle_bounds(scene) : empty_box();
  for (std::uint32_t i = 0; i < scene.lights.count; ++i) {
    const Light& light = scene.lights[i];
    const bool is_dark = is_zero(light.intensity) && !is_driven(scene, i),
               is_far = !is_dark && is_out_of_range(scene, bounds, light);
    note(c, dark_light(light.kind), is_dark);
    if (is_far) note(c, distant_light(light.kind), 1);
    if (!is_dark && !is_far) ++c->lights[static_cast<int>(light.kind)], ++c->light_count;
  }
}

// Returns whether an animation shows: it moves something, or lights and cameras stand where nodes put them.
bool moves(const Scene& scene) {
  if (!is_animated(scene)) return false;
  for (const Light& light : scene.lights)
    if (light.node != kNone) return true;
  for (const Camera& camera : scene.cameras)
    if (camera.node != kNone) return true;
  return !holds_still(scene);
}

}  // namespace

Census take_census(const Scene& scene, const Settings& settings) {
  CHECK_LE(scene.materials.count, kMaterialCountMax);
  CHECK(scene.material_maps.empty() || scene.material_maps.count == scene.materials.count);
  bool shows_unlit = !has(settings.forced_off, Effect::emission);
  Census c;
  const Array<const Triangle> triangles = scene.triangles;
  std::uint32_t used[kMaterialCountMax / 32] = {}, left = scene.materials.count;
  for (std::uint32_t i = 0; i < triangles.count;) {
    const std::uint32_t material = triangles[i].material(), mask = 1u << material % 32;
    std::uint32_t* word = &used[material / 32];
    if (!(*word & mask) && has_area(scene, triangles[i])) *word |= mask, --left;
    if (left == 0) break;
    i = *word & mask ? next_material(triangles, i) : i + 1;
  }
  for (const Reduction& r : scene.reductions) note(&c, r.what, r.count);
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    if (!(used[i / 32] >> i % 32 & 1)) continue;
    const Material m = lobe_bounds(scene, i);
    const ClearCoat* coat = coat_of(scene, i);
    if (coat && !shows_coat(scene, *coat)) note(&c, Invisible::black_coat, 1), coat = nullptr;
    const bool shines = coat && has_lobe(*coat);
    const Sheen* sheen = sheen_of(scene, i);
    if (sheen && !shows_sheen(scene, *sheen)) note(&c, Invisible::black_sheen, 1), sheen = nullptr;
    c.sheened += sheen != nullptr;
    const Iridescence* film = iridescence_of(scene, i);
    if (film && !shows_film(scene, *film)) note(&c, Invisible::black_film, 1), film = nullptr;
    c.iridescent += film != nullptr;
    const DiffuseTransmission* passing = diffuse_transmission_of(scene, i);
    if (passing && !shows_diffuse_transmission(scene, *passing)) note(&c, Invisible::opaque_leaf, 1), passing = nullptr;
    c.leafy += passing != nullptr;
    c.glass_mapped += !is_zero(m.transmission) && glass_map_of(scene, i);
    c.rough_glass += is_rough_glass(scene.materials[i]);
    bool is_bumpy = coat && shows_normal_map(scene, coat->normal, coat->normal_scale);
    bool has_normal_map = coat && coat->normal.texture != kNone, is_occluded = false;
    if (scene.material_maps.count) {
      const MaterialMaps& maps = scene.material_maps[i];
      c.metallic_roughness += has_lobe_map(maps);
      is_bumpy |= shows_normal_map(scene, maps.normal, maps.normal_scale);
      has_normal_map |= maps.normal.texture != kNone;
      is_occluded = shows_occlusion(scene, maps);
      c.occluded += is_occluded;
      note(&c, Invisible::white_occlusion, maps.occlusion.texture != kNone && !is_occluded);
    }
    c.bumpy += is_bumpy, c.coated += coat != nullptr;
    note(&c, Invisible::flat_normal_map, has_normal_map && !is_bumpy);
    if (!is_zero(m.specular) && has_grain(scene, i)) {
      const bool shows = shows_grain(scene, scene.grains[i]);
      c.grained += shows;
      note(&c, Invisible::black_grain, !shows);
    }
    c.with_levels += reads_levels(scene, i);
    if (reads_second(scene, i))
      ++c.second_uv;
    else if (is_occluded)
      c.second_uv_occlusion += reads_second_uvs(scene, scene.material_maps[i].occlusion);
    bool transmits = !is_zero(m.transmission);
    ++c.materials;
    c.specular += !is_zero(m.specular) || shines;
    c.mirror += !is_zero(m.mirror) || (coat && has_mirror(*coat));
    c.transmitting += transmits;
    c.absorbing += transmits && !m.thin && !is_zero(m.absorption);
    const bool has_holes = shows_holes(scene, i), is_clear = shows_background(scene, i),
               emits = shows_emission(scene, i);
    c.masked += has_holes, c.blended += is_clear, c.emissive += emits;
    note(&c, Invisible::mask_without_holes, m.alpha_mode == AlphaMode::mask && !has_holes);
    note(&c, Invisible::opaque_blend, m.alpha_mode == AlphaMode::blend && !is_clear);
    note(&c, Invisible::black_emission, !is_zero(m.emission) && !emits);
    c.unlit += m.unlit;
    c.textured += m.diffuse_texture.texture != kNone || m.emission_texture.texture != kNone;
    c.reflecting += reflects_surroundings(m) || shines;
    c.diffuse += !(m.unlit && shows_unlit) && (!is_zero(m.diffuse) || sheen || passing);
    c.one_sided += !m.double_sided && !transmits;
    c.scattering +=
        !(m.unlit && shows_unlit) && (!is_zero(m.diffuse) || !is_zero(m.specular) || shines || sheen || passing);
  }
  count_lights(scene, &c);
  c.has_normals = shows_vertex_normals(scene);
  c.has_colors = shows_vertex_colors(scene);
  note(&c, Invisible::white_vertex_colors, c.has_colors ? 0 : scene.colors.count);
  c.is_animated = moves(scene);
  if (is_animated(scene) && !c.is_animated) note(&c, Invisible::still_animation, scene.animations.count);
  return c;
}

}  // namespace pocketray
