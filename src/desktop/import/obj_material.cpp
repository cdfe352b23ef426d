// The mapping of MTL, by its illumination model `illum`:
//   0, 1        diffuse Kd                      2, 4, 9  and a glossy lobe Ks of Phong exponent Ns
//   3, 5, 8     mirror Ks (5: instead of Fresnel's rise to 1, which Ks of a metal hardly has)
//   6, 7        glass: transmits Tf (1 where absent), index of refraction Ni, mirror by Fresnel
//   any         emission Ke; opacity d = 1 − Tr, times map_d
// Models 4 and 9 are glass, too, by the specification; programs write them for opaque materials, Maya for all. A
// material without Kd takes its map's colours, or the default grey if nothing else makes it visible.
// With Pr or Pm (the extension for physically based rendering, as Blender exports it), all but glass becomes glTF's
// metallic-roughness material of base colour Kd. `aniso` and `anisor` (1 is a full turn) give a grain along u: to that
// material, or to Ward's lobe, which then replaces Phong's of Ns with α = 1/√(2(Ns + 2)), as high and as wide.
// `Pc` and `Pcr` are the strength and the roughness of a clear coat over any material.
#include "desktop/import/obj_material.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/brdf_list.h"
#include "desktop/import/broken_faces.h"
#include "desktop/import/files.h"
#include "desktop/import/image.h"
#include "desktop/import/import_error.h"
#include "desktop/import/obj_lookup.h"
#include "desktop/import/obj_mask.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

float bounded(float value, float low, float high) { return value > low ? std::min(value, high) : low; }
Vec3 bounded3(const Vec3& c, float high) {
  return {bounded(c.x, 0, high), bounded(c.y, 0, high), bounded(c.z, 0, high)};
}

// Returns false, with a remark, if the image cannot be loaded; the scene is still worth showing.
bool load(SceneBuilder* builder, const std::string& scene_path, const MtlMaterial& source, const MtlMap& map,
          Image* image) {
  if (map.name.empty()) return false;
  try {
    std::string path;
    *image = decode_image(
        builder, read_named({source.path, scene_path}, map.name, builder->options.byte_count_max, builder, &path),
        map.name);
    fit_image(*builder, image);
    return true;
  } catch (const ImportError& error) {
    note_remark(builder, std::string("a texture is missing: ") + error.what());
    return false;
  }
}

// -s and -o scale and shift (u, v) with v upward; ours runs downward.
TextureUse use_of(std::uint32_t texture, const MtlMap& map) {
  TextureUse use;
  use.texture = texture;
  for (int c = 0; c < 2; ++c)
    if (!is_coordinate({map.scale[c], map.offset[c], 0})) return use;
  use.m[0][0] = map.scale[0], use.m[0][2] = map.offset[0];
  use.m[1][1] = map.scale[1], use.m[1][2] = 1 - map.scale[1] - map.offset[1];
  return use;
}

void read_textures(SceneBuilder* builder, const std::string& scene_path, const MtlMaterial& source,
                   Material* material) {
  Image color, mask, glow;
  MtlMap map = source.diffuse_map;
  const bool has_color = load(builder, scene_path, source, map, &color);
  const bool has_mask = load(builder, scene_path, source, source.opacity_map, &mask);
  if (has_color) {
    make_opaque(&color);  // MTL has no alpha in map_Kd
    apply_range(map, &color);
  }
  if (has_mask) {
    material->opacity = source.opacity > 0 ? material->opacity : 1;  // the map decides
    const bool is_binary = put_mask(mask, source.opacity_map, has_color, &color, &map, builder);
    material->alpha_mode = is_binary && material->opacity == 1 ? AlphaMode::mask : AlphaMode::blend;
  }
  auto add = [&](Image* image, const MtlMap& used) {
    Wrap wrap = used.clamp ? Wrap::clamp : Wrap::repeat;
    return use_of(add_texture(builder, add_texels(builder, std::move(*image)), wrap, wrap, false), used);
  };
  if (has_color || has_mask) material->diffuse_texture = add(&color, map);
  if (has_color && is_zero(source.diffuse)) {
    if (source.has_diffuse)
      note_remark(builder, "material '" + source.name.substr(0, 60) +
                               "': Kd 0 would hide its map_Kd, which is shown as if Kd were 1");
    material->diffuse = {1, 1, 1};
  }
  if (load(builder, scene_path, source, source.emission_map, &glow)) {
    // -mm base gain: the gain scales; map_Ke without Ke means Ke 1.
    if (is_zero(material->emission)) material->emission = {1, 1, 1};
    material->emission = material->emission * bounded(source.emission_map.gain, 0, 1e6f);
    material->emission_texture = add(&glow, source.emission_map);
  }
}

bool is_glass(const MtlMaterial& source) { return source.illumination == 6 || source.illumination == 7; }
bool is_mirror(const MtlMaterial& source) {
  return source.illumination == 3 || source.illumination == 5 || source.illumination == 8;
}
bool is_physically_based(const MtlMaterial& source) { return source.roughness > 0 || source.metallic > 0; }

Vec3 diffuse_of(const MtlMaterial& source) {
  if (source.has_diffuse) return bounded3(source.diffuse, 1);
  const bool is_visible = is_glass(source) || (is_mirror(source) && !is_physically_based(source)) ||
                          !is_zero(source.emission) || !source.emission_map.name.empty();
  return is_visible ? Vec3{0, 0, 0} : Material().diffuse;
}

void name_unused(SceneBuilder* builder, const MtlMaterial& source) {
  if (source.sheen > 0) note_unused(builder, "sheen");
  if (is_glass(source) && (is_physically_based(source) || source.anisotropy > 0))
    note_unused(builder, "Pr, Pm and aniso of glass");
}

void name_invisible(SceneBuilder* builder, const MtlMaterial& source) {
  char line[32];
  std::snprintf(line, sizeof line, ", line %zu: ", source.opacity_line);
  note_remark(builder, "material '" + source.name.substr(0, 60) + "' is fully transparent (" +
                           source.file.substr(0, 100) + line + source.opacity_text + "); write 'd 1' there to see it");
}

void read_metallic_roughness(const MtlMaterial& source, Material* material) {
  MetallicRoughness model;
  model.base = material->diffuse;
  const float root = (material->ior - 1) / (material->ior + 1);
  model.dielectric = Vec3{1, 1, 1} * (material->ior > 1 ? root * root : 0.04f);
  model.grazing = 1;
  material->brdf = kGgx;
  set_lobes(model, bounded(source.metallic, 0, 1), bounded(source.roughness, 0, 1), 0, material);
}

// `Pc`, its strength, and `Pcr`, its roughness.
ClearCoat read_coat(const MtlMaterial& source) {
  ClearCoat coat;
  coat.strength = bounded(source.coat, 0, 1);
  coat.roughness = coat.roughness_low = bounded(source.coat_roughness, 0, 1);
  return coat;
}

Grain read_grain(const MtlMaterial& source) {
  const double strength = static_cast<double>(bounded(source.anisotropy, 0, 1));
  const double turns = static_cast<double>(source.rotation);
  const double angle = std::isfinite(turns) ? std::remainder(turns, 1) * 2 * kPi : 0;
  return {{static_cast<float>(strength * det_cos(angle)), static_cast<float>(strength * det_sin(angle))}, {}};
}

}  // namespace

std::uint32_t add_obj_material(SceneBuilder* builder, const std::string& scene_path, const MtlMaterial& source) {
  Material material;
  material.diffuse = diffuse_of(source);
  material.emission = bounded3(source.emission, 1e18f);
  material.ior = bounded(source.ior, 1, kIorMax);
  const Vec3 ks = bounded3(source.specular, 1), tf = bounded3(source.transmittance, 1);
  const int illum = source.illumination;
  if (is_glass(source)) {
    material.transmission = is_zero(tf) ? Vec3{1, 1, 1} : tf;
  } else {
    material.opacity = bounded(source.opacity, 0, 1);
    if (material.opacity < 1) material.alpha_mode = AlphaMode::blend;
    if (is_physically_based(source)) {  // Blender gives its metals illum 3, too
      read_metallic_roughness(source, &material);
    } else if (is_mirror(source)) {
      material.mirror = ks;
    } else if (illum == 2 || illum == 4 || illum == 9) {
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
  if (material.opacity == 0) name_invisible(builder, source);
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
