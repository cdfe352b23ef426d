// Maps: metallic and roughness, normals, occlusion (secs. 3.9.2, 3.9.3), KHR_materials_specular.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/color.h"
#include "base/limits.h"
#include "desktop/import/gltf.h"

namespace pocketray {
namespace {

// Metallic (blue) and roughness (green): their ranges and, if there is one, the use of the texture.
void read_metallic_roughness(GltfFile* file, const tinygltf::PbrMetallicRoughness& pbr, MaterialMaps* maps) {
  ChannelRange metallic = {255, 255}, roughness = {255, 255};
  if (pbr.metallicRoughnessTexture.index >= 0) {
    const Image& image = gltf_image(file, pbr.metallicRoughnessTexture.index, TexelKind::numbers);
    metallic = channel_range(image, 2), roughness = channel_range(image, 1);
  }
  auto scaled = [](float factor, std::uint8_t texel) { return factor * (static_cast<float>(texel) / 255); };
  maps->metallic = gltf_unit(pbr.metallicFactor), maps->roughness = gltf_unit(pbr.roughnessFactor);
  maps->metallic_low = scaled(maps->metallic, metallic.low);
  maps->metallic_high = scaled(maps->metallic, metallic.high);
  maps->roughness_low = scaled(maps->roughness, roughness.low);
  maps->roughness_high = scaled(maps->roughness, roughness.high);
  maps->metallic_roughness = gltf_texture_use(file, pbr.metallicRoughnessTexture, TexelKind::numbers);
}

// Normal and occlusion textures have their own structures in tinygltf.
template <class Info>
tinygltf::TextureInfo plain(const Info& info) {
  tinygltf::TextureInfo result;
  result.index = info.index, result.texCoord = info.texCoord, result.extensions = info.extensions;
  return result;
}

struct SpecularTextures {
  tinygltf::TextureInfo share, color;
};
SpecularTextures specular_textures(const tinygltf::Material& source) {
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_specular");
  if (!extension) return {};
  return {gltf_texture_info(*extension, "specularTexture"), gltf_texture_info(*extension, "specularColorTexture")};
}

tinygltf::TextureInfo anisotropy_texture(const tinygltf::Material& source) {
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_anisotropy");
  return extension ? gltf_texture_info(*extension, "anisotropyTexture") : tinygltf::TextureInfo();
}

// Even a dark texture keeps a trace of a lobe, for the reason given at gltf_map_mean().
constexpr float kLeastMean = 0x1p-10f;

Vec3 color_mean(const Image& image) {
  double sum[3] = {0, 0, 0};
  for (std::uint32_t texel : image.texels) {
    std::uint8_t rgba[4];
    std::memcpy(rgba, &texel, 4);
    for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(srgb_to_linear(rgba[c]));
  }
  Vec3 mean;
  for (int c = 0; c < 3; ++c)
    mean[c] = std::max(static_cast<float>(sum[c] / static_cast<double>(image.texels.size())), kLeastMean);
  return mean;
}

}  // namespace

Vec3 gltf_color_mean(GltfFile* file, int texture) { return color_mean(gltf_image(file, texture, TexelKind::colors)); }

MetallicRoughness gltf_mean_model(GltfFile* file, const tinygltf::Material& source, MetallicRoughness model) {
  const SpecularTextures textures = specular_textures(source);
  if (textures.share.index >= 0) {
    const Image& image = gltf_image(file, textures.share.index, TexelKind::colors);
    const float share = std::max(channel_mean(image, 3), kLeastMean);
    model.dielectric = model.dielectric * share, model.grazing *= share;
  }
  if (textures.color.index >= 0) model.dielectric *= gltf_color_mean(file, textures.color.index);
  return model;
}

float gltf_map_mean(GltfFile* file, int texture, int channel) {
  if (texture < 0) return 1;
  const Image& image = gltf_image(file, texture, TexelKind::numbers);
  const float mean = channel_mean(image, channel);
  return channel_range(image, channel).high > 0 ? std::max(mean, kLeastMean) : mean;
}

void gltf_read_maps(GltfFile* file, const tinygltf::Material& source, MaterialMaps* maps) {
  if (gltf_extension(source.extensions, "KHR_materials_unlit")) return;  // its texels would only take memory
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const SpecularTextures specular = specular_textures(source);
  read_metallic_roughness(file, pbr, maps);
  maps->specular = gltf_texture_use(file, specular.share);
  maps->specular_color = gltf_texture_use(file, specular.color);
  maps->normal = gltf_texture_use(file, plain(source.normalTexture), TexelKind::numbers);
  const double scale = source.normalTexture.scale, most = static_cast<double>(kNormalScaleMax);
  maps->normal_scale = std::isfinite(scale) ? static_cast<float>(std::min(std::max(scale, -most), most)) : 1.0f;
  maps->occlusion = gltf_texture_use(file, plain(source.occlusionTexture), TexelKind::numbers);
  maps->occlusion_strength = gltf_unit(source.occlusionTexture.strength);
}

GltfUvSets gltf_choose_uv_sets(GltfFile* file, const tinygltf::Material& source) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const SpecularTextures specular = specular_textures(source);
  const GltfCoatTextures coat = gltf_coat_textures(source);
  const GltfSheenTextures sheen = gltf_sheen_textures(source);
  const GltfGlassTextures glass = gltf_glass_textures(source);
  const GltfFilmTextures film = gltf_film_textures(source);
  const GltfPassingTextures passing = gltf_passing_textures(source);
  const bool leads = source.normalTexture.index < 0;  // the tangent frame serves only the coat's normals
  const tinygltf::Value* anisotropy = gltf_extension(source.extensions, "KHR_materials_anisotropy");
  const bool has_grain = anisotropy && gltf_number(*anisotropy, "anisotropyStrength", 0) > 0;
  const bool is_lit = !gltf_extension(source.extensions, "KHR_materials_unlit");
  const std::vector<double>& emission = source.emissiveFactor;
  const bool glows = std::any_of(emission.begin(), emission.end(), [](double factor) { return factor > 0; });
  const struct {
    const char* name;
    tinygltf::TextureInfo info;
    bool is_used;
  } all[] = {{"normal", plain(source.normalTexture), is_lit},
             {"clear coat normal", coat.normal, is_lit && leads},
             {"anisotropy", anisotropy_texture(source), is_lit && has_grain},
             {"base colour", pbr.baseColorTexture, true},
             {"metallic-roughness", pbr.metallicRoughnessTexture, is_lit},
             {"specular", specular.share, is_lit},
             {"specular colour", specular.color, is_lit},
             {"emission", source.emissiveTexture, is_lit && glows},
             {"occlusion", plain(source.occlusionTexture), is_lit},
             {"clear coat", coat.strength, is_lit},
             {"clear coat roughness", coat.roughness, is_lit},
             {"sheen colour", sheen.color, is_lit},
             {"sheen roughness", sheen.roughness, is_lit},
             {"transmission", glass.transmission, is_lit},
             {"thickness", glass.thickness, is_lit},
             {"iridescence", film.strength, is_lit},
             {"iridescence thickness", film.thickness, is_lit},
             {"diffuse transmission", passing.strength, is_lit},
             {"diffuse transmission colour", passing.color, is_lit}};
  const char* first = nullptr;
  GltfUvSets sets;
  for (const auto& texture : all) {
    if (!texture.is_used || texture.info.index < 0) continue;
    const int set = gltf_uv_set(texture.info);
    if (!first)
      first = texture.name, sets.first = set;
    else if (set != sets.first && sets.second < 0)
      sets.second = set;
    else if (set != sets.first && set != sets.second)
      note_remark(file->builder, std::string(texture.name) + " textures use the texture coordinates of the " + first +
                                     ", a third set being left out");
  }
  if (!first && has_grain) sets.first = 0;
  return sets;
}

}  // namespace pocketray
