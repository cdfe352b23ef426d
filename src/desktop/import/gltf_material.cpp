// Metallic-roughness materials (sec. 3.9) and the KHR_materials extensions.
//
// scene/metallic_roughness.h has the mapping, for base colour c, metallic m, roughness r and transmission t. Here, for
// index of refraction n:
//   reflectance at normal incidence d = ((n − 1)/(n + 1))² × specular colour and factor, at grazing incidence g =
//   factor
//                (KHR_materials_specular)
//   absorption = −ln(attenuation colour)/attenuation distance (KHR_materials_volume)
// A metallicRoughness texture becomes a map, and the material has the lobes of its mean; a transparent material uses
// only the mean. A transmission texture multiplies its factor by its mean.
#include <algorithm>
#include <cmath>

#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/brdf_list.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

Vec3 color3(const std::vector<double>& values, const Vec3& fallback) {
  if (values.size() < 3) return fallback;
  return {gltf_unit(values[0]), gltf_unit(values[1]), gltf_unit(values[2])};
}

// Mean of a data texture's channel; 1 without the texture.
float texture_mean(GltfFile* file, int texture, int channel, const char* name) {
  if (texture < 0) return 1;
  note_remark(file->builder, std::string("only the mean of ") + name + " textures is used");
  return channel_mean(gltf_image(file, texture, TexelKind::numbers), channel);
}

void read_volume(const tinygltf::ExtensionMap& extensions, Material* material) {
  const tinygltf::Value* volume = gltf_extension(extensions, "KHR_materials_volume");
  material->thin = !volume || !(gltf_number(*volume, "thicknessFactor", 0) > 0);
  double distance = volume ? gltf_number(*volume, "attenuationDistance", 0) : 0;  // absent: infinite
  if (material->thin || !(distance > 0)) return;
  Vec3 color = gltf_color(*volume, "attenuationColor", {1, 1, 1});
  for (int c = 0; c < 3; ++c) {
    double kept = std::min(std::max(static_cast<double>(color[c]), 1e-6), 1.0);
    material->absorption[c] = static_cast<float>(std::min(-det_log(kept) / distance, 1e18));
  }
}

// KHR_materials_specular: a dielectric's reflectance at normal incidence and at grazing incidence.
struct DielectricSpecular {
  Vec3 normal;
  float grazing;
};

DielectricSpecular read_specular(const tinygltf::ExtensionMap& extensions, float ior) {
  const float root = (ior - 1) / (ior + 1), reflectance = root * root;
  const tinygltf::Value* extension = gltf_extension(extensions, "KHR_materials_specular");
  if (!extension) return {{reflectance, reflectance, reflectance}, 1};
  DielectricSpecular d = {{reflectance, reflectance, reflectance},
                          gltf_unit(gltf_number(*extension, "specularFactor", 1))};
  const tinygltf::Value color =
      extension->Has("specularColorFactor") ? extension->Get("specularColorFactor") : tinygltf::Value();
  for (int c = 0; c < 3; ++c) {
    const bool given = color.IsArray() && color.ArrayLen() == 3 && color.Get(c).IsNumber();
    const double factor = given ? color.Get(c).GetNumberAsDouble() : 1;  // may be above 1
    d.normal[c] = gltf_unit(factor * static_cast<double>(reflectance)) * d.grazing;
  }
  return d;
}

void read_surface(GltfFile* file, const tinygltf::Material& source, Material* material, MaterialMaps* maps) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const int texture = pbr.metallicRoughnessTexture.index;
  if (const tinygltf::Value* ior = gltf_extension(source.extensions, "KHR_materials_ior"))
    material->ior =
        static_cast<float>(std::min(std::max(gltf_number(*ior, "ior", 1.5), 1.0), static_cast<double>(kIorMax)));
  float transmission = 0;
  if (const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_transmission")) {
    transmission = gltf_unit(gltf_number(*extension, "transmissionFactor", 0));
    if (transmission > 0)
      transmission *= texture_mean(file, gltf_texture_info(*extension, "transmissionTexture").index, 0, "transmission");
  }
  const DielectricSpecular dielectric = read_specular(source.extensions, material->ior);
  maps->model = {color3(pbr.baseColorFactor, {1, 1, 1}), dielectric.normal, dielectric.grazing};
  material->brdf = kGgx;
  set_lobes(gltf_mean_model(file, source, maps->model), gltf_unit(pbr.metallicFactor) * gltf_map_mean(file, texture, 2),
            gltf_unit(pbr.roughnessFactor) * gltf_map_mean(file, texture, 1), transmission, material);
  const bool is_clear = !is_zero(material->transmission);
  if (is_clear) read_volume(source.extensions, material);
  if (is_clear && material->roughness > 0) note_remark(file->builder, "rough transmission is rendered clear");
  gltf_read_maps(file, source, is_clear, maps);
}

void read_emission(GltfFile* file, const tinygltf::Material& source, Material* material) {
  double strength = 1;
  if (const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_emissive_strength"))
    strength = std::min(std::max(gltf_number(*extension, "emissiveStrength", 1), 0.0), 1e18);
  material->emission = color3(source.emissiveFactor, {0, 0, 0}) * static_cast<float>(strength);
  if (!is_zero(material->emission)) material->emission_texture = gltf_texture_use(file, source.emissiveTexture);
}

Material convert(GltfFile* file, const tinygltf::Material& source, MaterialMaps* maps) {
  Material material;
  read_surface(file, source, &material, maps);
  read_emission(file, source, &material);
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  material.diffuse_texture = gltf_texture_use(file, pbr.baseColorTexture);
  material.opacity = pbr.baseColorFactor.size() > 3 ? gltf_unit(pbr.baseColorFactor[3]) : 1;
  material.alpha_mode = source.alphaMode == "MASK"    ? AlphaMode::mask
                        : source.alphaMode == "BLEND" ? AlphaMode::blend
                                                      : AlphaMode::opaque;
  material.alpha_cutoff = std::isfinite(source.alphaCutoff) && source.alphaCutoff > 0
                              ? static_cast<float>(std::min(source.alphaCutoff, 2.0))
                              : 0.0f;
  material.double_sided = source.doubleSided;
  material.unlit = gltf_extension(source.extensions, "KHR_materials_unlit") != nullptr;
  if (material.unlit) {
    Vec3 color = color3(pbr.baseColorFactor, {1, 1, 1});
    TextureUse texture = material.diffuse_texture;
    AlphaMode mode = material.alpha_mode;
    float opacity = material.opacity, cutoff = material.alpha_cutoff;
    std::uint8_t double_sided = material.double_sided;
    material = Material(), *maps = MaterialMaps();
    material.diffuse = color, material.diffuse_texture = texture, material.alpha_mode = mode;
    material.opacity = opacity, material.alpha_cutoff = cutoff, material.double_sided = double_sided,
    material.unlit = 1;
  }
  if (const tinygltf::Value* volume = gltf_extension(source.extensions, "KHR_materials_volume"))
    if (volume->Has("thicknessTexture")) note_unused(file->builder, "thickness maps");
  return material;
}

// KHR_materials_anisotropy.
Grain read_grain(GltfFile* file, const tinygltf::Material& source, const Material& material) {
  Grain grain;
  const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_anisotropy");
  if (!extension || is_zero(material.specular)) return grain;
  const double strength = static_cast<double>(gltf_unit(gltf_number(*extension, "anisotropyStrength", 0)));
  const double angle = std::remainder(gltf_number(*extension, "anisotropyRotation", 0), 2 * kPi);
  grain.direction = {static_cast<float>(strength * det_cos(angle)), static_cast<float>(strength * det_sin(angle))};
  if (strength > 0)
    grain.texture = gltf_texture_use(file, gltf_texture_info(*extension, "anisotropyTexture"), TexelKind::numbers);
  return grain;
}

}  // namespace

static std::uint32_t read_material(GltfFile* file, int index, const tinygltf::Material& given) {
  SceneArrays& out = *file->builder->out;
  static const tinygltf::Material kDefault;
  const bool translate = gltf_has_specular_glossiness(given);
  const tinygltf::Material translated = translate ? gltf_without_specular_glossiness(file, given) : kDefault;
  const tinygltf::Material& source = translate ? translated : given;
  file->current_uv_sets = gltf_choose_uv_sets(file, source);
  MaterialMaps maps;
  Material material = convert(file, source, &maps);
  const Grain grain = read_grain(file, source, material);
  const ClearCoat coat = gltf_read_coat(file, source);
  const Sheen sheen = gltf_read_sheen(file, source);
  const bool needs_uvs = material.diffuse_texture.texture != kNone || material.emission_texture.texture != kNone ||
                         has_map(maps) || has_strength(grain) || is_textured(coat) || is_textured(sheen);
  if (index >= 0 && needs_uvs) file->uv_sets[static_cast<std::size_t>(index)] = file->current_uv_sets;
  const std::uint32_t added = add_material(file->builder, material, source.name);
  if (!is_zero(material.transmission) && !gltf_extension(source.extensions, "KHR_materials_volume"))
    file->builder->glass.push_back(added);
  if (has_map(maps)) {
    out.material_maps.resize(added);
    out.material_maps.push_back(maps);
  }
  if (has_strength(grain)) {
    out.grains.resize(added);
    out.grains.push_back(grain);
  }
  if (coat.strength > 0) {
    out.clear_coats.resize(added);
    out.clear_coats.push_back(coat);
  }
  if (!is_zero(sheen.color)) {
    out.sheens.resize(added);
    out.sheens.push_back(sheen);
  }
  return added;
}

std::uint32_t gltf_material(GltfFile* file, int index) {
  std::uint32_t* known = index < 0 ? &file->default_material : &file->materials[static_cast<std::size_t>(index)];
  static const tinygltf::Material kDefault;
  while (*known == kNone) try {
      const tinygltf::Material& given = index < 0 ? kDefault : file->model.materials[static_cast<std::size_t>(index)];
      *known = read_material(file, index, gltf_without_lost_textures(*file, given));
    } catch (const LostImage&) {  // at most once per image
    }
  return *known;
}

const tinygltf::Value* gltf_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  auto it = extensions.find(name);
  return it == extensions.end() || !it->second.IsObject() ? nullptr : &it->second;
}

double gltf_number(const tinygltf::Value& object, const char* key, double fallback) {
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsNumber()) return fallback;
  double value = object.Get(key).GetNumberAsDouble();
  return std::isfinite(value) ? value : fallback;
}

Vec3 gltf_color(const tinygltf::Value& object, const char* key, const Vec3& fallback) {
  if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() < 3) return fallback;
  Vec3 color = fallback;
  for (int c = 0; c < 3; ++c) {
    const tinygltf::Value& value = object.Get(key).Get(c);
    if (value.IsNumber()) color[c] = gltf_unit(value.GetNumberAsDouble());
  }
  return color;
}

tinygltf::TextureInfo gltf_texture_info(const tinygltf::Value& object, const char* key) {
  tinygltf::TextureInfo info;
  if (object.Has(key) && object.Get(key).IsObject()) {
    const tinygltf::Value& value = object.Get(key);
    const double index = gltf_number(value, "index", -1), set = gltf_number(value, "texCoord", 0);
    info.index = index >= 0 && index < 1e9 ? static_cast<int>(index) : -1;
    info.texCoord = set >= 0 && set < 64 ? static_cast<int>(set) : 0;
    constexpr const char* kTransform = "KHR_texture_transform";
    if (value.Has("extensions") && value.Get("extensions").Has(kTransform))
      info.extensions[kTransform] = value.Get("extensions").Get(kTransform);
  }
  return info;
}

}  // namespace pocketray
