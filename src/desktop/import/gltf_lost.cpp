// Materials whose images are missing or cannot be decoded show the colours of their factors.
#include "desktop/import/gltf.h"

namespace pocketray {
namespace {

bool is_lost(const GltfFile& file, double texture) {
  if (!(texture >= 0) || !(texture < static_cast<double>(file.model.textures.size()))) return false;
  return file.lost_images.count(file.model.textures[static_cast<std::size_t>(texture)].source) > 0;
}

// Removes uses of lost textures: objects with an index.
tinygltf::Value without_lost(const GltfFile& file, const tinygltf::Value& value) {
  if (!value.IsObject()) return value;
  tinygltf::Value::Object kept;
  for (const std::string& key : value.Keys()) {
    const tinygltf::Value& member = value.Get(key);
    if (member.IsObject() && is_lost(file, gltf_number(member, "index", -1))) continue;
    kept[key] = without_lost(file, member);
  }
  return tinygltf::Value(kept);
}

}  // namespace

tinygltf::Material gltf_without_lost_textures(const GltfFile& file, const tinygltf::Material& source) {
  tinygltf::Material material = source;
  tinygltf::PbrMetallicRoughness& pbr = material.pbrMetallicRoughness;
  for (int* index : {&pbr.baseColorTexture.index, &pbr.metallicRoughnessTexture.index, &material.normalTexture.index,
                     &material.occlusionTexture.index, &material.emissiveTexture.index})
    if (is_lost(file, *index)) *index = -1;
  for (auto& extension : material.extensions) extension.second = without_lost(file, extension.second);
  return material;
}

}  // namespace pocketray
