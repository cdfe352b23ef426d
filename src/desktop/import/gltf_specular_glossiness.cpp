// KHR_materials_pbrSpecularGlossiness, archived by Khronos but common in older files, as metallic-roughness with
// KHR_materials_specular, for diffuse colour c, specular colour s and glossiness g:
//   base colour = c · (1 − max(s)), metallic 0, roughness = 1 − g
//   specular colour factor = s / 0.04, its texture's colours that of the specularGlossinessTexture
// The mean of the texture's alpha scales g, and the mean of its colours reduces the base colour.
#include <algorithm>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

constexpr const char* kName = "KHR_materials_pbrSpecularGlossiness";
constexpr double kReflectance = 0.04;  // of index of refraction 1.5, which KHR_materials_specular scales

std::vector<double> color_of(const tinygltf::Value& object, const char* key) {
  const Vec3 color = gltf_color(object, key, {1, 1, 1});
  return {static_cast<double>(color.x), static_cast<double>(color.y), static_cast<double>(color.z)};
}

double alpha_of(const tinygltf::Value& object, const char* key) {
  if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() < 4) return 1;
  const tinygltf::Value& alpha = object.Get(key).Get(3);
  return alpha.IsNumber() ? static_cast<double>(gltf_unit(alpha.GetNumberAsDouble())) : 1;
}

}  // namespace

bool gltf_has_specular_glossiness(const tinygltf::Material& source) {
  return gltf_extension(source.extensions, kName) != nullptr;
}

tinygltf::Material gltf_without_specular_glossiness(GltfFile* file, const tinygltf::Material& source) {
  const tinygltf::Value* extension = gltf_extension(source.extensions, kName);
  tinygltf::Material result = source;
  const std::vector<double> specular = color_of(*extension, "specularFactor");
  std::vector<double> base = color_of(*extension, "diffuseFactor");
  double glossiness = static_cast<double>(gltf_unit(gltf_number(*extension, "glossinessFactor", 1)));
  const tinygltf::TextureInfo texture = gltf_texture_info(*extension, "specularGlossinessTexture");
  Vec3 mean = {1, 1, 1};
  if (texture.index >= 0) {
    mean = gltf_color_mean(file, texture.index);
    note_remark(file->builder, "only the mean of glossiness textures is used");
    glossiness *= static_cast<double>(channel_mean(gltf_image(file, texture.index, TexelKind::colors), 3));
  }
  double reflected = 0;
  for (int c = 0; c < 3; ++c)
    reflected = std::max(reflected, specular[static_cast<std::size_t>(c)] * static_cast<double>(mean[c]));
  for (double& c : base) c *= 1 - reflected;
  base.push_back(alpha_of(*extension, "diffuseFactor"));
  tinygltf::PbrMetallicRoughness& pbr = result.pbrMetallicRoughness;
  pbr = tinygltf::PbrMetallicRoughness();
  pbr.baseColorFactor = base, pbr.baseColorTexture = gltf_texture_info(*extension, "diffuseTexture");
  pbr.metallicFactor = 0, pbr.roughnessFactor = 1 - glossiness;
  tinygltf::Value::Array factor;
  for (double s : specular) factor.emplace_back(s / kReflectance);
  tinygltf::Value::Object lobe;
  lobe["specularColorFactor"] = tinygltf::Value(factor);
  if (texture.index >= 0) lobe["specularColorTexture"] = extension->Get("specularGlossinessTexture");
  result.extensions.erase("KHR_materials_ior");
  result.extensions["KHR_materials_specular"] = tinygltf::Value(lobe);
  return result;
}

}  // namespace pocketray
