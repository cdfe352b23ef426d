// The mapping of MTL, by its illumination model `illum`:
//   0, 1        diffuse Kd                      2        and a glossy lobe Ks of Phong exponent Ns
//   3, 5, 8     mirror Ks (5: instead of Fresnel's rise to 1, which Ks of a metal hardly has)
//   4, 6, 7, 9  glass: transmits Tf (1 where absent), index of refraction Ni, mirror by Fresnel
//   any         emission Ke; opacity d = 1 − Tr, times map_d
// With Pr or Pm (the extension for physically based rendering, as Blender exports it), all but glass is glTF's
// metallic-roughness material of base colour Kd. `aniso` and `anisor`, a turn being 1, are a grain along u: of that
// material, or of Ward's lobe, which then stands in for Phong's of Ns with α = 1/√(2(Ns + 2)), as high and as wide.
// `Pc` and `Pcr` are the strength and the roughness of a clear coat over any material.
#include "import/obj_material.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/brdf_list.h"
#include "import/files.h"
#include "import/image.h"
#include "import/import_error.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

float bounded(float value, float low, float high) { return value > low ? std::min(value, high) : low; }
Vec3 bounded3(const float* c, float high) {
  return {bounded(c[0], 0, high), bounded(c[1], 0, high), bounded(c[2], 0, high)};
}

// False, with a remark, if the image cannot be loaded; the scene is still worth showing.
bool load(SceneBuilder* builder, const std::string& scene_path, const std::string& name, Image* image) {
  if (name.empty()) return false;
  try {
    *image =
        decode_image(builder, read_beside(scene_path, name, builder->options.byte_count_max, &builder->files), name);
    shrink_image(image, builder->options.texture_side_max);
    return true;
  } catch (const ImportError& error) {
    note_remark(builder, std::string("a texture is missing: ") + error.what());
    return false;
  }
}

// -s and -o scale and shift (u, v) with v upward; ours runs downward.
TextureUse use_of(std::uint32_t texture, const tinyobj::texture_option_t& option) {
  TextureUse use;
  use.texture = texture;
  for (int c = 0; c < 2; ++c)
    if (!is_coordinate({option.scale[c], option.origin_offset[c], 0})) return use;
  use.m[0][0] = option.scale[0], use.m[0][2] = option.origin_offset[0];
  use.m[1][1] = option.scale[1], use.m[1][2] = 1 - option.scale[1] - option.origin_offset[1];
  return use;
}

void put_byte(std::uint32_t* texel, int channel, std::uint8_t value) {
  std::uint8_t rgba[4];
  std::memcpy(rgba, texel, 4);
  rgba[channel] = value;
  std::memcpy(texel, rgba, 4);
}

// Puts the mask's red channel into the alpha of `image`, nearest texel; true if every alpha is 0 or 255.
bool put_alpha(Image* image, const Image& mask) {
  bool binary = true;
  for (std::uint32_t y = 0; y < image->height; ++y)
    for (std::uint32_t x = 0; x < image->width; ++x) {
      std::size_t from = static_cast<std::size_t>(y * std::uint64_t(mask.height) / image->height) * mask.width +
                         static_cast<std::size_t>(x * std::uint64_t(mask.width) / image->width);
      std::uint8_t red;
      std::memcpy(&red, &mask.texels[from], 1);
      binary &= red == 0 || red == 255;
      put_byte(&image->texels[static_cast<std::size_t>(y) * image->width + x], 3, red);
    }
  return binary;
}

void read_textures(SceneBuilder* builder, const std::string& scene_path, const tinyobj::material_t& source,
                   Material* material) {
  Image color, mask, glow;
  bool has_color = load(builder, scene_path, source.diffuse_texname, &color);
  bool has_mask = load(builder, scene_path, source.alpha_texname, &mask);
  if (has_mask && !has_color) {
    color.width = mask.width, color.height = mask.height;
    color.texels.assign(mask.texels.size(), 0xFFFFFFFFu);
  }
  if (!has_mask)
    for (std::uint32_t& texel : color.texels) put_byte(&texel, 3, 255);  // MTL has no alpha in map_Kd
  if (has_mask)
    material->alpha_mode = put_alpha(&color, mask) && material->opacity == 1 ? AlphaMode::mask : AlphaMode::blend;
  auto add = [&](Image* image, const tinyobj::texture_option_t& option) {
    Wrap wrap = option.clamp ? Wrap::clamp : Wrap::repeat;
    return use_of(add_texture(builder, add_texels(builder, std::move(*image)), wrap, wrap, false), option);
  };
  if (has_color || has_mask)
    material->diffuse_texture = add(&color, has_color ? source.diffuse_texopt : source.alpha_texopt);
  if (load(builder, scene_path, source.emissive_texname, &glow)) {
    // -mm base gain: the gain scales; map_Ke without Ke means Ke 1.
    float gain = bounded(source.emissive_texopt.contrast, 0, 1e6f);
    if (is_zero(material->emission)) material->emission = {1, 1, 1};
    material->emission = material->emission * gain;
    material->emission_texture = add(&glow, source.emissive_texopt);
  }
}

bool is_glass(const tinyobj::material_t& source) {
  return source.illum == 4 || source.illum == 6 || source.illum == 7 || source.illum == 9;
}
bool is_physically_based(const tinyobj::material_t& source) { return source.roughness > 0 || source.metallic > 0; }

void name_unused(SceneBuilder* builder, const tinyobj::material_t& source) {
  if (!source.bump_texname.empty() || !source.normal_texname.empty()) note_unused(builder, "bump and normal maps");
  if (!source.specular_texname.empty() || !source.specular_highlight_texname.empty())
    note_unused(builder, "specular maps");
  if (!source.ambient_texname.empty()) note_unused(builder, "ambient maps");
  if (!source.displacement_texname.empty()) note_unused(builder, "displacement maps");
  if (!source.reflection_texname.empty()) note_unused(builder, "reflection maps");
  if (source.sheen > 0 || !source.sheen_texname.empty()) note_unused(builder, "sheen");
  if (is_glass(source) && (is_physically_based(source) || source.anisotropy > 0))
    note_unused(builder, "Pr, Pm and aniso of glass");
  if (!source.roughness_texname.empty() || !source.metallic_texname.empty())
    note_unused(builder, "roughness and metallic maps");
}

void read_metallic_roughness(const tinyobj::material_t& source, Material* material) {
  MetallicRoughness model;
  model.base = material->diffuse;
  const float root = (material->ior - 1) / (material->ior + 1);
  model.dielectric = Vec3{1, 1, 1} * (material->ior > 1 ? root * root : 0.04f);
  model.grazing = 1;
  material->brdf = kGgx;
  set_lobes(model, bounded(source.metallic, 0, 1), bounded(source.roughness, 0, 1), 0, material);
}

// `Pc`, its strength, and `Pcr`, its roughness.
ClearCoat read_coat(const tinyobj::material_t& source) {
  ClearCoat coat;
  coat.strength = bounded(source.clearcoat_thickness, 0, 1);
  coat.roughness = coat.roughness_low = bounded(source.clearcoat_roughness, 0, 1);
  return coat;
}

Grain read_grain(const tinyobj::material_t& source) {
  const double strength = static_cast<double>(bounded(source.anisotropy, 0, 1));
  const double turns = static_cast<double>(source.anisotropy_rotation);
  const double angle = std::isfinite(turns) ? std::remainder(turns, 1) * 2 * kPi : 0;
  return {{static_cast<float>(strength * det_cos(angle)), static_cast<float>(strength * det_sin(angle))}, {}};
}

}  // namespace

std::uint32_t add_obj_material(SceneBuilder* builder, const std::string& scene_path,
                               const tinyobj::material_t& source) {
  Material material;
  material.diffuse = bounded3(source.diffuse, 1);
  material.emission = bounded3(source.emission, 1e18f);
  material.ior = bounded(source.ior, 1, kIorMax);
  Vec3 ks = bounded3(source.specular, 1), tf = bounded3(source.transmittance, 1);
  int illum = source.illum;
  if (is_glass(source)) {
    material.transmission = is_zero(tf) ? Vec3{1, 1, 1} : tf;
  } else {
    material.opacity = bounded(source.dissolve, 0, 1);
    if (material.opacity < 1) material.alpha_mode = AlphaMode::blend;
    if (is_physically_based(source)) {  // Blender gives its metals illum 3, too
      read_metallic_roughness(source, &material);
    } else if (illum == 3 || illum == 5 || illum == 8) {
      material.mirror = ks;
    } else if (illum == 2) {
      material.specular = ks;
      material.exponent = bounded(source.shininess, 0, kPhongExponentMax);
    }
  }
  const Grain grain = read_grain(source);
  const bool brushed = !is_zero(material.specular) && has_strength(grain);
  if (brushed && material.brdf == kPhong)
    material.brdf = kWard, material.roughness = std::sqrt(0.5f / (material.exponent + 2));
  read_textures(builder, scene_path, source, &material);
  name_unused(builder, source);
  const std::uint32_t index = add_material(builder, material, source.name);
  if (brushed) {
    builder->out->grains.resize(index);
    builder->out->grains.push_back(grain);
  }
  const ClearCoat coat = read_coat(source);
  if (coat.strength > 0) {
    builder->out->clear_coats.resize(index);
    builder->out->clear_coats.push_back(coat);
  }
  return index;
}

}  // namespace pocketray
