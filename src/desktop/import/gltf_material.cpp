// Metallic-roughness materials (sec. 3.9) and the KHR_materials extensions.
//
// scene/metallic_roughness.h has the mapping, for base colour c, metallic m, roughness r and transmission t. Here, for
// index of refraction n:
//   reflectance at normal incidence d = ((n − 1)/(n + 1))² × specular colour and factor, at grazing incidence g =
//   factor
//                (KHR_materials_specular)
//   absorption = −ln(attenuation colour)/attenuation distance (KHR_materials_volume)
// Textures of metallic, roughness and transmission become maps, and the material has the lobes of their means.
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

// Mean of the metallic values; below 1 if any texel is, so that what these transmit is part of the mean lobes.
float mean_metallic(GltfFile* file, const tinygltf::PbrMetallicRoughness& pbr) {
  const int texture = pbr.metallicRoughnessTexture.index;
  const float mean = gltf_unit(pbr.metallicFactor) * gltf_map_mean(file, texture, 2);
  if (texture < 0 || channel_range(gltf_image(file, texture, TexelKind::numbers), 2).low == 255) return mean;
  return std::min(mean, 1 - 0x1p-10f);
}

void read_surface(GltfFile* file, const tinygltf::Material& source, Material* material, MaterialMaps* maps,
                  GlassMap* glass) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  const int texture = pbr.metallicRoughnessTexture.index;
  if (const tinygltf::Value* ior = gltf_extension(source.extensions, "KHR_materials_ior"))
    material->ior =
        static_cast<float>(std::min(std::max(gltf_number(*ior, "ior", 1.5), 1.0), static_cast<double>(kIorMax)));
  const GltfTransmission transmission = gltf_read_transmission(file, source);
  const DielectricSpecular dielectric = read_specular(source.extensions, material->ior);
  maps->model = {color3(pbr.baseColorFactor, {1, 1, 1}), dielectric.normal, dielectric.grazing};
  material->brdf = kGgx;
  const float metallic = transmission.mean > 0 ? mean_metallic(file, pbr)
                                               : gltf_unit(pbr.metallicFactor) * gltf_map_mean(file, texture, 2);
  set_lobes(gltf_mean_model(file, source, maps->model), metallic,
            gltf_unit(pbr.roughnessFactor) * gltf_map_mean(file, texture, 1), transmission.mean, material);
  if (!is_zero(material->transmission)) {
    glass->transmission = transmission.factor;
    glass->transmission_texture = gltf_texture_use(file, gltf_glass_textures(source).transmission, TexelKind::numbers);
    gltf_read_volume(file, source, material, glass);
  }
  gltf_read_maps(file, source, maps);
}

void read_emission(GltfFile* file, const tinygltf::Material& source, Material* material) {
  double strength = 1;
  if (const tinygltf::Value* extension = gltf_extension(source.extensions, "KHR_materials_emissive_strength"))
    strength = std::min(std::max(gltf_number(*extension, "emissiveStrength", 1), 0.0), 1e18);
  material->emission = color3(source.emissiveFactor, {0, 0, 0}) * static_cast<float>(strength);
  if (!is_zero(material->emission)) material->emission_texture = gltf_texture_use(file, source.emissiveTexture);
}

Material convert(GltfFile* file, const tinygltf::Material& source, MaterialMaps* maps, GlassMap* glass) {
  Material material;
  read_surface(file, source, &material, maps, glass);
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
    material = Material(), *maps = MaterialMaps(), *glass = GlassMap();
    material.diffuse = color, material.diffuse_texture = texture, material.alpha_mode = mode;
    material.opacity = opacity, material.alpha_cutoff = cutoff, material.double_sided = double_sided,
    material.unlit = 1;
  }
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
  GlassMap glass;
  Material material = convert(file, source, &maps, &glass);
  const Grain grain = read_grain(file, source, material);
  const ClearCoat coat = gltf_read_coat(file, source);
  const Sheen sheen = gltf_read_sheen(file, source);
  const Iridescence film = gltf_read_film(file, source);
  const DiffuseTransmission passing = gltf_read_passing(file, source);
  const bool needs_uvs = material.diffuse_texture.texture != kNone || material.emission_texture.texture != kNone ||
                         has_map(maps) || has_strength(grain) || is_textured(coat) || is_textured(sheen) ||
                         is_textured(glass) || is_textured(film) || is_textured(passing);
  if (index >= 0 && needs_uvs) file->uv_sets[static_cast<std::size_t>(index)] = file->current_uv_sets;
  const std::uint32_t added = add_material(file->builder, material, source.name);
  if (!is_zero(material.transmission) && !gltf_extension(source.extensions, "KHR_materials_volume"))
    file->builder->glass.push_back(added);
  if (glass.thickness > 0) file->builder->volumes.push_back(added);
  if (has_map(maps) || glass.transmission > 0) {
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
  if (glass.transmission > 0) {
    out.glass_maps.resize(added);
    out.glass_maps.push_back(glass);
  }
  if (film.strength > 0) {
    out.iridescences.resize(added);
    out.iridescences.push_back(film);
  }
  if (passing.strength > 0) {
    out.diffuse_transmissions.resize(added);
    out.diffuse_transmissions.push_back(passing);
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
