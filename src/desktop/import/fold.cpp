#include "desktop/import/fold.h"

#include <algorithm>

#include "base/check.h"
#include "scene/diffuse_transmission.h"
#include "scene/invisible.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

// Returns whether a vertex of the material has a colour.
bool has_colors(const Scene& scene, std::uint32_t material) {
  if (scene.colors.empty()) return false;
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) {
      if (t.material() != material || v >= scene.colors.count) continue;
      const Rgba16& c = scene.colors[v];
      if (c.r != 65535 || c.g != 65535 || c.b != 65535) return true;
    }
  return false;
}

}  // namespace

// The lobes are those that lobes_at() of shade/material_maps.cpp has at every point.
void fold_glass(const Scene& scene, std::uint32_t material, SceneArrays* arrays) {
  CHECK(arrays != nullptr);
  if (!glass_map_of(scene, material)) return;
  GlassMap& glass = arrays->glass_maps[material];
  const MaterialMaps& maps = arrays->material_maps[material];
  Material& m = arrays->materials[material];
  std::uint8_t value[4];
  // The importer does not take what a black texture leaves opaque for glass.
  if (glass.transmission_texture.texture != kNone && has_one_value(scene, glass.transmission_texture, value) &&
      value[0] > 0)
    glass.transmission *= static_cast<float>(value[0]) / 255, glass.transmission_texture = TextureUse();
  if (glass.thickness_texture.texture != kNone && has_one_value(scene, glass.thickness_texture, value))
    glass.thickness *= static_cast<float>(value[1]) / 255, glass.thickness_texture = TextureUse();
  if (glass.transmission_texture.texture != kNone || glass.thickness > 0 || has_lobe_map(maps)) return;
  if (m.diffuse_texture.texture != kNone || has_colors(scene, material)) return;
  const float stored = static_cast<float>(static_cast<std::uint16_t>(maps.metallic * 65535 + 0.5f)) / 65535;
  set_lobes(maps.model, stored, maps.roughness, glass.transmission, &m);
  m.diffuse = maps.model.base * (1 - maps.metallic) * (1 - glass.transmission);
  glass = GlassMap();
}

// Strength and thickness are those that find_film() of shade/film.cpp has at every point.
std::uint32_t fold_film(const Scene& scene, std::uint32_t material, SceneArrays* arrays) {
  CHECK(arrays != nullptr);
  if (material >= arrays->iridescences.size() || !(arrays->iridescences[material].strength > 0)) return 0;
  Iridescence& film = arrays->iridescences[material];
  if (!shows_film(scene, film)) {
    film = Iridescence();
    return 1;
  }
  std::uint8_t value[4];
  if (film.strength_texture.texture != kNone && has_one_value(scene, film.strength_texture, value))
    film.strength *= static_cast<float>(value[0]) / 255, film.strength_texture = TextureUse();
  if (film.thickness_texture.texture == kNone || !has_one_value(scene, film.thickness_texture, value)) return 0;
  film.thickness_high =
      film.thickness_low + (film.thickness_high - film.thickness_low) * (static_cast<float>(value[1]) / 255);
  film.thickness_texture = TextureUse();
  return 0;
}

std::uint32_t drop_passing(const Scene& scene, std::uint32_t material, SceneArrays* arrays) {
  CHECK(arrays != nullptr);
  const DiffuseTransmission* passing = diffuse_transmission_of(scene, material);
  if (!passing || shows_diffuse_transmission(scene, *passing)) return 0;
  arrays->diffuse_transmissions[material] = DiffuseTransmission();
  return 1;
}

void drop_empty_maps(SceneArrays* arrays) {
  CHECK(arrays != nullptr);
  auto drop = [](auto* entries, auto is_used) {
    if (std::none_of(entries->begin(), entries->end(), is_used)) entries->clear();
  };
  drop(&arrays->glass_maps, [](const GlassMap& glass) { return glass.transmission > 0; });
  drop(&arrays->iridescences, [](const Iridescence& film) { return film.strength > 0; });
  drop(&arrays->diffuse_transmissions, [](const DiffuseTransmission& passing) { return passing.strength > 0; });
  if (arrays->glass_maps.empty()) drop(&arrays->material_maps, has_map);
}

}  // namespace pocketray
