// KHR_materials_transmission, KHR_materials_volume and KHR_materials_iridescence.
#include <algorithm>

#include "base/fmath.h"
#include "base/limits.h"
#include "desktop/import/gltf.h"

namespace pocketray {
namespace {

// Null: the material has none.
const tinygltf::Value* lit_extension(const tinygltf::Material& source, const char* name, const char* factor) {
  if (gltf_extension(source.extensions, "KHR_materials_unlit")) return nullptr;
  const tinygltf::Value* extension = gltf_extension(source.extensions, name);
  return extension && gltf_number(*extension, factor, 0) > 0 ? extension : nullptr;
}

const tinygltf::Value* transmission_extension(const tinygltf::Material& source) {
  return lit_extension(source, "KHR_materials_transmission", "transmissionFactor");
}

const tinygltf::Value* film_extension(const tinygltf::Material& source) {
  return lit_extension(source, "KHR_materials_iridescence", "iridescenceFactor");
}

}  // namespace

GltfGlassTextures gltf_glass_textures(const tinygltf::Material& source) {
  const tinygltf::Value* extension = transmission_extension(source);
  if (!extension) return {};
  GltfGlassTextures textures;
  textures.transmission = gltf_texture_info(*extension, "transmissionTexture");
  if (const tinygltf::Value* volume = gltf_extension(source.extensions, "KHR_materials_volume"))
    textures.thickness = gltf_texture_info(*volume, "thicknessTexture");
  return textures;
}

GltfTransmission gltf_read_transmission(GltfFile* file, const tinygltf::Material& source) {
  const tinygltf::Value* extension = transmission_extension(source);
  if (!extension) return {};
  const float factor = gltf_unit(gltf_number(*extension, "transmissionFactor", 0));
  return {factor, factor * gltf_map_mean(file, gltf_glass_textures(source).transmission.index, 0)};
}

void gltf_read_volume(GltfFile* file, const tinygltf::Material& source, Material* material, GlassMap* glass) {
  const tinygltf::Value* volume = gltf_extension(source.extensions, "KHR_materials_volume");
  const double thickness = volume ? std::min(gltf_number(*volume, "thicknessFactor", 0), double(kCoordinateMax)) : 0;
  const tinygltf::TextureInfo texture = gltf_glass_textures(source).thickness;
  material->thin = !(thickness > 0);
  if (thickness > 0 && texture.index >= 0) {
    material->thin = 1;  // until the mesh is known, see glass.h
    glass->thickness = static_cast<float>(thickness);
    glass->thickness_texture = gltf_texture_use(file, texture, TexelKind::numbers);
  }
  const double distance = volume ? gltf_number(*volume, "attenuationDistance", 0) : 0;  // absent: infinite
  if (!(thickness > 0) || !(distance > 0)) return;
  const Vec3 color = gltf_color(*volume, "attenuationColor", {1, 1, 1});
  for (int c = 0; c < 3; ++c) {
    const double kept = std::min(std::max(static_cast<double>(color[c]), 1e-6), 1.0);
    material->absorption[c] = static_cast<float>(std::min(-det_log(kept) / distance, 1e18));
  }
}

GltfFilmTextures gltf_film_textures(const tinygltf::Material& source) {
  const tinygltf::Value* extension = film_extension(source);
  if (!extension) return {};
  return {gltf_texture_info(*extension, "iridescenceTexture"),
          gltf_texture_info(*extension, "iridescenceThicknessTexture")};
}

Iridescence gltf_read_film(GltfFile* file, const tinygltf::Material& source) {
  Iridescence film;
  const tinygltf::Value* extension = film_extension(source);
  if (!extension) return film;
  auto within = [&](const char* key, double fallback, double low, double high) {
    return static_cast<float>(std::min(std::max(gltf_number(*extension, key, fallback), low), high));
  };
  constexpr double most = static_cast<double>(kFilmThicknessMax);
  film.strength = gltf_unit(gltf_number(*extension, "iridescenceFactor", 0));
  film.ior = within("iridescenceIor", 1.3, 1, static_cast<double>(kIorMax));
  film.thickness_low = within("iridescenceThicknessMinimum", 100, 0, most);
  film.thickness_high = within("iridescenceThicknessMaximum", 400, 0, most);
  const GltfFilmTextures textures = gltf_film_textures(source);
  film.strength_texture = gltf_texture_use(file, textures.strength, TexelKind::numbers);
  film.thickness_texture = gltf_texture_use(file, textures.thickness, TexelKind::numbers);
  return film;
}

}  // namespace pocketray
