// KHR_materials_diffuse_transmission.
#include "desktop/import/gltf.h"

namespace pocketray {
namespace {

// Null: the material has none.
const tinygltf::Value* passing_extension(const tinygltf::Material& source) {
  if (gltf_extension(source.extensions, "KHR_materials_unlit")) return nullptr;
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_diffuse_transmission");
  return extension && gltf_number(*extension, "diffuseTransmissionFactor", 0) > 0 ? extension : nullptr;
}

}  // namespace

GltfPassingTextures gltf_passing_textures(const tinygltf::Material& source) {
  const tinygltf::Value* extension = passing_extension(source);
  if (!extension) return {};
  return {gltf_texture_info(*extension, "diffuseTransmissionTexture"),
          gltf_texture_info(*extension, "diffuseTransmissionColorTexture")};
}

DiffuseTransmission gltf_read_passing(GltfFile* file, const tinygltf::Material& source) {
  DiffuseTransmission passing;
  const tinygltf::Value* extension = passing_extension(source);
  if (!extension) return passing;
  passing.strength = gltf_unit(gltf_number(*extension, "diffuseTransmissionFactor", 0));
  passing.color = gltf_color(*extension, "diffuseTransmissionColorFactor", {1, 1, 1});
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const float metallic = gltf_unit(pbr.metallicFactor) * gltf_map_mean(file, pbr.metallicRoughnessTexture.index, 2);
  passing.color = passing.color * ((1 - metallic) * (1 - gltf_read_transmission(file, source).mean));
  const GltfPassingTextures textures = gltf_passing_textures(source);
  passing.strength_texture = gltf_texture_use(file, textures.strength);
  passing.color_texture = gltf_texture_use(file, textures.color);
  const tinygltf::Value* volume = gltf_extension(source.extensions, "KHR_materials_volume");
  if (volume && gltf_number(*volume, "thicknessFactor", 0) > 0)
    note_remark(file->builder, "light scattered inside bodies is rendered as if they were thin, like leaves");
  return passing;
}

}  // namespace pocketray
