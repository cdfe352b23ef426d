// KHR_materials_sheen.
#include "desktop/import/gltf.h"

namespace pocketray {
namespace {

// Null: the material has no sheen.
const tinygltf::Value* sheen_extension(const tinygltf::Material& source) {
  if (gltf_extension(source.extensions, "KHR_materials_unlit")) return nullptr;
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_sheen");
  return extension && !is_zero(gltf_color(*extension, "sheenColorFactor", {0, 0, 0})) ? extension : nullptr;
}

}  // namespace

GltfSheenTextures gltf_sheen_textures(const tinygltf::Material& source) {
  const tinygltf::Value* extension = sheen_extension(source);
  if (!extension) return {};
  return {gltf_texture_info(*extension, "sheenColorTexture"), gltf_texture_info(*extension, "sheenRoughnessTexture")};
}

Sheen gltf_read_sheen(GltfFile* file, const tinygltf::Material& source) {
  Sheen sheen;
  const tinygltf::Value* extension = sheen_extension(source);
  if (!extension) return sheen;
  sheen.color = gltf_color(*extension, "sheenColorFactor", {0, 0, 0});
  sheen.roughness = sheen.roughness_low = gltf_unit(gltf_number(*extension, "sheenRoughnessFactor", 0));
  const GltfSheenTextures textures = gltf_sheen_textures(source);
  sheen.color_texture = gltf_texture_use(file, textures.color);
  if (textures.roughness.index < 0 || !(sheen.roughness > 0)) return sheen;
  const ChannelRange range = channel_range(gltf_image(file, textures.roughness.index, TexelKind::colors), 3);
  sheen.roughness_low = sheen.roughness * (static_cast<float>(range.low) / 255);
  sheen.roughness_texture = gltf_texture_use(file, textures.roughness);
  return sheen;
}

}  // namespace pocketray
