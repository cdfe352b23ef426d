// Validates textures of materials.
#include <initializer_list>

#include "base/check.h"
#include "scene/metallic_roughness.h"
#include "scene/validate_checks.h"

namespace pocketray {

constexpr float kGrainSquareMax = 1.00001f;  // a unit vector, rounded

Status check_texture_use(const char* array, const char* field, std::uint32_t index, const TextureUse& use,
                         const Scene& scene) {
  CHECK(array != nullptr && field != nullptr);
  for (const auto& row : use.m)
    for (float x : row)
      if (!is_coordinate(x)) return failure("%s[%u].%s has a transform that is not finite", array, index, field);
  if (use.texture == kNone) return success();
  if (use.texture >= scene.textures.count)
    return failure("%s[%u].%s is texture %u of %u", array, index, field, use.texture, scene.textures.count);
  if (scene.uvs.empty()) return failure("%s[%u].%s needs uvs, the scene has none", array, index, field);
  if (scene.textures[use.texture].uv_set > 0 && scene.second_uvs.empty())
    return failure("%s[%u].%s needs second_uvs, the scene has none", array, index, field);
  return success();
}

Status validate_maps(const Scene& scene, std::uint32_t index) {
  const Material& m = scene.materials[index];
  const MaterialMaps& maps = scene.material_maps[index];
  const FieldRange fields[] = {
      {"base.x", maps.model.base.x, 0, 1},
      {"base.y", maps.model.base.y, 0, 1},
      {"base.z", maps.model.base.z, 0, 1},
      {"dielectric.x", maps.model.dielectric.x, 0, 1},
      {"dielectric.y", maps.model.dielectric.y, 0, 1},
      {"dielectric.z", maps.model.dielectric.z, 0, 1},
      {"grazing", maps.model.grazing, 0, 1},
      {"metallic", maps.metallic, 0, 1},
      {"roughness", maps.roughness, 0, 1},
      {"metallic_high", maps.metallic_high, 0, 1},
      {"metallic_low", maps.metallic_low, 0, maps.metallic_high},
      {"roughness_high", maps.roughness_high, 0, 1},
      {"roughness_low", maps.roughness_low, 0, maps.roughness_high},
      {"normal_scale", maps.normal_scale, -kNormalScaleMax, kNormalScaleMax},
      {"occlusion_strength", maps.occlusion_strength, 0, 1},
  };
  RETURN_IF_ERROR(check_fields("material_maps", index, fields));
  RETURN_IF_ERROR(check_texture_use("material_maps", "metallic_roughness", index, maps.metallic_roughness, scene));
  RETURN_IF_ERROR(check_texture_use("material_maps", "normal", index, maps.normal, scene));
  if (maps.normal.texture != kNone && scene.textures[maps.normal.texture].uv_set > 0)
    return failure("material_maps[%u].normal reads second_uvs, its frame is that of uvs", index);
  RETURN_IF_ERROR(check_texture_use("material_maps", "occlusion", index, maps.occlusion, scene));
  RETURN_IF_ERROR(check_texture_use("material_maps", "specular", index, maps.specular, scene));
  RETURN_IF_ERROR(check_texture_use("material_maps", "specular_color", index, maps.specular_color, scene));
  const bool is_glass = glass_map_of(scene, index) != nullptr;
  if (!has_lobe_map(maps) && !is_glass) return success();
  if (m.unlit || (!is_zero(m.transmission) && !is_glass))
    return failure("material_maps[%u] changes lobes: its material is unlit or transmits light", index);
  // Kernels decide by the mean lobe whether the material has one at all.
  const Material most = lobe_bounds(scene, index);
  if (is_zero(m.specular) && !is_zero(most.specular))
    return failure("material_maps[%u] makes a glossy lobe, but materials[%u] has none", index, index);
  if (is_zero(m.transmission) && !is_zero(most.transmission))
    return failure("glass_maps[%u] transmits light, but materials[%u] does not", index, index);
  return success();
}

static Status validate_grain(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.grains.count);
  const Grain& grain = scene.grains[index];
  const Vec2 d = grain.direction;
  if (!(d.x * d.x + d.y * d.y <= kGrainSquareMax))
    return failure("grains[%u].direction must not be longer than 1", index);
  return check_texture_use("grains", "texture", index, grain.texture, scene);
}

struct NamedUse {
  const char* field;
  const TextureUse* use;
};
static Status check_texture_uses(const char* array, std::uint32_t index, const Scene& scene,
                                 std::initializer_list<NamedUse> uses) {
  for (const NamedUse& named : uses) RETURN_IF_ERROR(check_texture_use(array, named.field, index, *named.use, scene));
  return success();
}

// Validates an array with an element for each material, or none.
static Status validate_each(const char* array, std::uint32_t count, const Scene& scene,
                            Status (*validate)(const Scene& scene, std::uint32_t index)) {
  if (count != 0 && count != scene.materials.count)
    return failure("%u %s for %u materials: there must be one for each or none", count, array, scene.materials.count);
  for (std::uint32_t i = 0; i < count; ++i) RETURN_IF_ERROR(validate(scene, i));
  return success();
}

Status validate_grains(const Scene& scene) {
  return validate_each("grains", scene.grains.count, scene, validate_grain);
}

static Status validate_coat(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.clear_coats.count);
  const ClearCoat& coat = scene.clear_coats[index];
  const FieldRange fields[] = {
      {"strength", coat.strength, 0, 1},
      {"roughness", coat.roughness, 0, 1},
      {"roughness_low", coat.roughness_low, 0, coat.roughness},
      {"normal_scale", coat.normal_scale, -kNormalScaleMax, kNormalScaleMax},
  };
  RETURN_IF_ERROR(check_fields("clear_coats", index, fields));
  RETURN_IF_ERROR(check_texture_use("clear_coats", "strength_texture", index, coat.strength_texture, scene));
  RETURN_IF_ERROR(check_texture_use("clear_coats", "roughness_texture", index, coat.roughness_texture, scene));
  RETURN_IF_ERROR(check_texture_use("clear_coats", "normal", index, coat.normal, scene));
  if (coat.normal.texture != kNone && scene.textures[coat.normal.texture].uv_set > 0)
    return failure("clear_coats[%u].normal reads second_uvs, its frame is that of uvs", index);
  if (coat.roughness_texture.texture == kNone && coat.roughness_low != coat.roughness)
    return failure("clear_coats[%u].roughness_low is %g without a texture, it must be the roughness, %g", index,
                   static_cast<double>(coat.roughness_low), static_cast<double>(coat.roughness));
  if (coat.strength > 0 && scene.materials[index].unlit)
    return failure("clear_coats[%u] coats materials[%u], which is unlit", index, index);
  return success();
}

Status validate_clear_coats(const Scene& scene) {
  return validate_each("clear_coats", scene.clear_coats.count, scene, validate_coat);
}

static Status validate_sheen(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.sheens.count);
  const Sheen& sheen = scene.sheens[index];
  const FieldRange fields[] = {
      {"color.x", sheen.color.x, 0, 1},
      {"color.y", sheen.color.y, 0, 1},
      {"color.z", sheen.color.z, 0, 1},
      {"roughness", sheen.roughness, 0, 1},
      {"roughness_low", sheen.roughness_low, 0, sheen.roughness},
  };
  RETURN_IF_ERROR(check_fields("sheens", index, fields));
  RETURN_IF_ERROR(check_texture_use("sheens", "color_texture", index, sheen.color_texture, scene));
  RETURN_IF_ERROR(check_texture_use("sheens", "roughness_texture", index, sheen.roughness_texture, scene));
  if (sheen.roughness_texture.texture == kNone && sheen.roughness_low != sheen.roughness)
    return failure("sheens[%u].roughness_low is %g without a texture, it must be the roughness, %g", index,
                   static_cast<double>(sheen.roughness_low), static_cast<double>(sheen.roughness));
  if (!is_zero(sheen.color) && scene.materials[index].unlit)
    return failure("sheens[%u] covers materials[%u], which is unlit", index, index);
  return success();
}

Status validate_sheens(const Scene& scene) {
  return validate_each("sheens", scene.sheens.count, scene, validate_sheen);
}

static Status validate_glass_map(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.glass_maps.count);
  const GlassMap& glass = scene.glass_maps[index];
  const FieldRange fields[] = {
      {"transmission", glass.transmission, 0, 1},
      {"thickness", glass.thickness, 0, kCoordinateMax},
  };
  RETURN_IF_ERROR(check_fields("glass_maps", index, fields));
  if (glass.transmission > 0 && scene.material_maps.empty())
    return failure("glass_maps[%u] needs material_maps, the scene has none", index);
  return check_texture_uses(
      "glass_maps", index, scene,
      {{"transmission_texture", &glass.transmission_texture}, {"thickness_texture", &glass.thickness_texture}});
}

Status validate_glass_maps(const Scene& scene) {
  return validate_each("glass_maps", scene.glass_maps.count, scene, validate_glass_map);
}

static Status validate_iridescence(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.iridescences.count);
  const Iridescence& film = scene.iridescences[index];
  const FieldRange fields[] = {
      {"strength", film.strength, 0, 1},
      {"ior", film.ior, 1, kIorMax},
      {"thickness_low", film.thickness_low, 0, kFilmThicknessMax},
      {"thickness_high", film.thickness_high, 0, kFilmThicknessMax},
  };
  RETURN_IF_ERROR(check_fields("iridescences", index, fields));
  if (film.strength > 0 && scene.materials[index].unlit)
    return failure("iridescences[%u] covers materials[%u], which is unlit", index, index);
  return check_texture_uses(
      "iridescences", index, scene,
      {{"strength_texture", &film.strength_texture}, {"thickness_texture", &film.thickness_texture}});
}

Status validate_iridescences(const Scene& scene) {
  return validate_each("iridescences", scene.iridescences.count, scene, validate_iridescence);
}

static Status validate_diffuse_transmission(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.diffuse_transmissions.count);
  const DiffuseTransmission& passing = scene.diffuse_transmissions[index];
  const FieldRange fields[] = {
      {"strength", passing.strength, 0, 1},
      {"color.x", passing.color.x, 0, 1},
      {"color.y", passing.color.y, 0, 1},
      {"color.z", passing.color.z, 0, 1},
  };
  RETURN_IF_ERROR(check_fields("diffuse_transmissions", index, fields));
  if (passing.strength > 0 && scene.materials[index].unlit)
    return failure("diffuse_transmissions[%u] belongs to materials[%u], which is unlit", index, index);
  return check_texture_uses(
      "diffuse_transmissions", index, scene,
      {{"strength_texture", &passing.strength_texture}, {"color_texture", &passing.color_texture}});
}

Status validate_diffuse_transmissions(const Scene& scene) {
  return validate_each("diffuse_transmissions", scene.diffuse_transmissions.count, scene,
                       validate_diffuse_transmission);
}

Status validate_material_maps(const Scene& scene) {
  return validate_each("material_maps", scene.material_maps.count, scene, validate_maps);
}

}  // namespace pocketray
