// KHR_materials_clearcoat.
#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "desktop/import/gltf.h"

namespace pocketray {

GltfCoatTextures gltf_coat_textures(const tinygltf::Material& source) {
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_clearcoat");
  if (!extension || !(gltf_number(*extension, "clearcoatFactor", 0) > 0)) return {};
  return {gltf_texture_info(*extension, "clearcoatTexture"), gltf_texture_info(*extension, "clearcoatRoughnessTexture"),
          gltf_texture_info(*extension, "clearcoatNormalTexture")};
}

ClearCoat gltf_read_coat(GltfFile* file, const tinygltf::Material& source) {
  ClearCoat coat;
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_clearcoat");
  if (!extension || gltf_extension(source.extensions, "KHR_materials_unlit")) return coat;
  coat.strength = gltf_unit(gltf_number(*extension, "clearcoatFactor", 0));
  if (!(coat.strength > 0)) return coat;
  coat.roughness = coat.roughness_low = gltf_unit(gltf_number(*extension, "clearcoatRoughnessFactor", 0));
  const GltfCoatTextures textures = gltf_coat_textures(source);
  coat.strength_texture = gltf_texture_use(file, textures.strength, TexelKind::numbers);
  if (textures.roughness.index >= 0 && coat.roughness > 0) {
    const ChannelRange range = channel_range(gltf_image(file, textures.roughness.index, TexelKind::numbers), 1);
    coat.roughness_low = coat.roughness * (static_cast<float>(range.low) / 255);
    coat.roughness_texture = gltf_texture_use(file, textures.roughness, TexelKind::numbers);
  }
  if (textures.normal.index < 0) return coat;
  if (gltf_uv_set(textures.normal) != file->current_uv_sets.first) {
    note_unused(file->builder, "normal textures of clear coats with texture coordinates other than the base's");
    return coat;
  }
  coat.normal = gltf_texture_use(file, textures.normal, TexelKind::numbers);
  const double scale = gltf_number(extension->Get("clearcoatNormalTexture"), "scale", 1),
               most = static_cast<double>(kNormalScaleMax);
  coat.normal_scale = static_cast<float>(std::min(std::max(scale, -most), most));
  return coat;
}

}  // namespace pocketray
