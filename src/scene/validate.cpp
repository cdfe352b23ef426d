// Validates static content: geometry, materials, textures, lights, cameras.
#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"
#include "base/scan.h"
#include "scene/baked.h"
#include "scene/texel_blocks.h"
#include "scene/triangle_scan.h"
#include "scene/validate_checks.h"

namespace pocketray {
namespace {

constexpr float kFloatMax = std::numeric_limits<float>::max();

Status check_count(const char* array, std::uint32_t count, std::uint32_t limit) {
  if (count <= limit) return success();
  return failure("%u %s, at most %u are supported: simplify the model", count, array, limit);
}

Status check_per_vertex(const char* array, std::uint32_t count, const Scene& scene) {
  if (count == 0 || count == scene.positions.count) return success();
  return failure("%u %s for %u vertices: there must be one for each or none", count, array, scene.positions.count);
}

Status validate_counts(const Scene& scene) {
  RETURN_IF_ERROR(check_count("vertices", scene.positions.count, kVertexCountMax));
  RETURN_IF_ERROR(check_count("triangles", scene.triangles.count, kTriangleCountMax));
  RETURN_IF_ERROR(check_count("materials", scene.materials.count, kMaterialCountMax));
  RETURN_IF_ERROR(check_count("textures", scene.textures.count, kTextureCountMax));
  RETURN_IF_ERROR(check_count("lights", scene.lights.count, kLightCountMax));
  RETURN_IF_ERROR(check_count("cameras", scene.cameras.count, kCameraCountMax));
  RETURN_IF_ERROR(check_count("nodes", scene.nodes.count, kNodeCountMax));
  RETURN_IF_ERROR(check_per_vertex("normals", scene.normals.count, scene));
  RETURN_IF_ERROR(check_per_vertex("uvs", scene.uvs.count, scene));
  RETURN_IF_ERROR(check_per_vertex("second_uvs", scene.second_uvs.count, scene));
  RETURN_IF_ERROR(check_per_vertex("tangents", scene.tangents.count, scene));
  return check_per_vertex("colors", scene.colors.count, scene);
}

Status validate_info(const SceneInfo& info) {
  if (!std::memchr(info.name, 0, sizeof info.name)) return failure("the scene's name is not terminated");
  if (info.frame_count < 1) return failure("info.frame_count is 0: it must be at least 1");
  if (info.default_lights > 1 || info.default_camera > 1)
    return failure("info.default_lights and info.default_camera must be 0 or 1");
  const FieldRange fields[] = {
      {"background.x", info.background.x, 0, kRadianceMax},
      {"background.y", info.background.y, 0, kRadianceMax},
      {"background.z", info.background.z, 0, kRadianceMax},
      {"ambient.x", info.ambient.x, 0, kRadianceMax},
      {"ambient.y", info.ambient.y, 0, kRadianceMax},
      {"ambient.z", info.ambient.z, 0, kRadianceMax},
      {"exposure", info.exposure, kExposureMin, kExposureMax},
      {"frames_per_second", info.frames_per_second, kFrameRateMin, kFrameRateMax},
      {"auto_exposure", info.auto_exposure, 0, 2},
  };
  return check_fields("info", 0, fields);
}

Status check_material(const Scene& scene, std::uint32_t index) {
  const Material& m = scene.materials[index];
  const FieldRange fields[] = {
      {"diffuse.x", m.diffuse.x, 0, 1},
      {"diffuse.y", m.diffuse.y, 0, 1},
      {"diffuse.z", m.diffuse.z, 0, 1},
      {"specular.x", m.specular.x, 0, 1},
      {"specular.y", m.specular.y, 0, 1},
      {"specular.z", m.specular.z, 0, 1},
      {"exponent", m.exponent, 0, kPhongExponentMax},
      {"roughness", m.roughness, 0, 1},
      {"grazing", m.grazing, 0, 1},
      {"mirror.x", m.mirror.x, 0, 1},
      {"mirror.y", m.mirror.y, 0, 1},
      {"mirror.z", m.mirror.z, 0, 1},
      {"specular_tinted.x", m.specular_tinted.x, 0, m.specular.x},
      {"specular_tinted.y", m.specular_tinted.y, 0, m.specular.y},
      {"specular_tinted.z", m.specular_tinted.z, 0, m.specular.z},
      {"mirror_tinted.x", m.mirror_tinted.x, 0, m.mirror.x},
      {"mirror_tinted.y", m.mirror_tinted.y, 0, m.mirror.y},
      {"mirror_tinted.z", m.mirror_tinted.z, 0, m.mirror.z},
      {"transmission.x", m.transmission.x, 0, 1},
      {"transmission.y", m.transmission.y, 0, 1},
      {"transmission.z", m.transmission.z, 0, 1},
      {"ior", m.ior, 1, kIorMax},
      {"absorption.x", m.absorption.x, 0, kRadianceMax},
      {"absorption.y", m.absorption.y, 0, kRadianceMax},
      {"absorption.z", m.absorption.z, 0, kRadianceMax},
      {"emission.x", m.emission.x, 0, kRadianceMax},
      {"emission.y", m.emission.y, 0, kRadianceMax},
      {"emission.z", m.emission.z, 0, kRadianceMax},
      {"opacity", m.opacity, 0, 1},
      {"alpha_cutoff", m.alpha_cutoff, 0, kFloatMax},
  };
  RETURN_IF_ERROR(check_fields("materials", index, fields));
  RETURN_IF_ERROR(check_texture_use("materials", "diffuse_texture", index, m.diffuse_texture, scene));
  RETURN_IF_ERROR(check_texture_use("materials", "emission_texture", index, m.emission_texture, scene));
  if (m.brdf >= kBrdfCountMax)
    return failure("materials[%u].brdf is %u, at most %u exist", index, m.brdf, kBrdfCountMax);
  if (m.alpha_mode > AlphaMode::blend) return failure("materials[%u] has an unknown alpha mode", index);
  if (m.double_sided > 1 || m.unlit > 1 || m.thin > 1)
    return failure("materials[%u]: double_sided, unlit and thin must be 0 or 1", index);
  if (m.unlit && !(is_zero(m.specular) && is_zero(m.mirror) && is_zero(m.transmission) && is_zero(m.emission)))
    return failure("materials[%u] is unlit: it has no highlight, mirror, transmission or emission", index);
  return success();
}

Status validate_texture(const Scene& scene, std::uint32_t index) {
  const Texture& t = scene.textures[index];
  if (t.width < 1 || t.height < 1 || t.width > kTextureSideMax || t.height > kTextureSideMax)
    return failure("textures[%u] is %u by %u texels, its sides must lie in 1 to %u", index, t.width, t.height,
                   kTextureSideMax);
  if (static_cast<int>(t.format) >= kTexelFormatCount || t.reserved[0] || t.reserved[1])
    return failure("textures[%u] is of an unknown format", index);
  if (t.uv_set > 1) return failure("textures[%u] reads texture coordinates %u, there are two sets", index, t.uv_set);
  const std::uint32_t level_max = level_count_max(t.width, t.height);
  if (t.level_count < 1 || t.level_count > level_max)
    return failure("textures[%u] of %u by %u texels has %u levels, it must have 1 to %u", index, t.width, t.height,
                   t.level_count, level_max);
  if (!is_range(t.texel_begin, level_words(t.format, t.width, t.height, t.level_count), scene.texels.count))
    return failure("textures[%u] extends beyond the scene's %u texels", index, scene.texels.count);
  if (t.wrap_u > Wrap::clamp || t.wrap_v > Wrap::clamp || t.nearest > 1)
    return failure("textures[%u] has an unknown wrap mode or filter", index);
  return success();
}

Status validate_light(const Scene& scene, std::uint32_t index) {
  const Light& light = scene.lights[index];
  if (light.kind > LightKind::directional) return failure("lights[%u] is of an unknown kind", index);
  if (!is_coordinate(light.position)) return failure("lights[%u].position is not finite or too far away", index);
  if (!is_unit(light.direction)) return failure("lights[%u].direction is not of length 1", index);
  if (!is_index_or_none(light.node, scene.nodes.count))
    return failure("lights[%u] follows node %u of %u", index, light.node, scene.nodes.count);
  if (light.node != kNone && scene.animations.empty())
    return failure("lights[%u] follows a node, but nothing is animated: place it in world space", index);
  const FieldRange fields[] = {
      {"intensity.x", light.intensity.x, 0, kRadianceMax},
      {"intensity.y", light.intensity.y, 0, kRadianceMax},
      {"intensity.z", light.intensity.z, 0, kRadianceMax},
      {"range", light.range, 0, kFloatMax},
      {"cos_inner", light.cos_inner, -1, 1},
      {"cos_outer", light.cos_outer, -1, light.cos_inner},
  };
  return check_fields("lights", index, fields);
}

Status validate_camera(const Scene& scene, std::uint32_t index) {
  const Camera& camera = scene.cameras[index];
  if (!is_coordinate(camera.eye) || !is_coordinate(camera.target) || !is_coordinate(camera.up))
    return failure("cameras[%u] has a vector that is not finite or too long", index);
  if (camera.eye == camera.target) return failure("cameras[%u] has its eye and target at the same point", index);
  if (is_zero(camera.up)) return failure("cameras[%u].up is zero", index);
  if (camera.projection > Projection::orthographic) return failure("cameras[%u] has an unknown projection", index);
  if (!is_index_or_none(camera.node, scene.nodes.count))
    return failure("cameras[%u] follows node %u of %u", index, camera.node, scene.nodes.count);
  if (camera.node != kNone && scene.animations.empty())
    return failure("cameras[%u] follows a node, but nothing is animated: place it in world space", index);
  const FieldRange fields[] = {
      {"vertical_fov", camera.vertical_fov, kFieldOfViewMin, kFieldOfViewMax},
      {"vertical_extent", camera.vertical_extent, kVerticalExtentMin, kCoordinateMax},
  };
  return check_fields("cameras", index, fields);
}

Status validate_default_view(const Scene& scene) {
  if (scene.default_view.empty()) return success();
  const DefaultView& view = scene.default_view[0];
  if (scene.default_view.count > 1)
    return failure("%u default_views: there must be one or none", scene.default_view.count);
  if (view.is_room > 1) return failure("default_view[0].is_room is %u: it must be 0 or 1", view.is_room);
  if (view.side >= kDefaultViewSides)
    return failure("default_view[0].side is %u of %u sides", view.side, kDefaultViewSides);
  if (!is_unit(view.opening) && !is_zero(view.opening))
    return failure("default_view[0].opening is neither of length 1 nor zero");
  const FieldRange fields[] = {{"inside_share", view.inside_share, 0, 1}};
  return check_fields("default_view", 0, fields);
}

Status validate_framings(const Scene& scene) {
  if (scene.framings.count > 1 && scene.framings.count != scene.animations.count + 1)
    return failure("%u framings for %u animations: there must be one for each and one more, or one, or none",
                   scene.framings.count, scene.animations.count);
  for (std::uint32_t i = 0; i < scene.framings.count; ++i) {
    const Framing& framing = scene.framings[i];
    if (!is_coordinate(framing.eye) || !is_coordinate(framing.target))
      return failure("framings[%u] stands or looks too far away", i);
    if (!is_unit(framing.backward) && !is_zero(framing.backward))
      return failure("framings[%u].backward is neither of length 1 nor zero", i);
    for (const auto& side : framing.reach)
      for (float reach : side)
        if (!magnitude_at_most(reach, 4 * kCoordinateMax))
          return failure("framings[%u].reach is not a number or too large", i);
  }
  return success();
}

}  // namespace

bool are_coordinates(const void* values, std::size_t count) {
  constexpr std::int32_t kMagnitude = 0x7FFFFFFF;
  return static_cast<std::uint32_t>(largest_word(values, count, kMagnitude)) <= float_bits(kCoordinateMax);
}

Status check_normals(const char* array, Array<const Vec3> normals) {
  // Quickly up to four of which one is zero or at fault, and then these one by one.
  for (std::uint32_t i = 0; (i = find_square_outside(normals, i, kUnitSquareMin, kUnitSquareMax)) < normals.count;)
    for (std::uint32_t end = i + std::min(4u, normals.count - i); i < end; ++i)
      if (!is_unit(normals[i]) && !is_zero(normals[i]))
        return failure("%s[%u] is neither of length 1 nor zero", array, i);
  return success();
}

// Returns true only if all triangles have vertices and materials of the scene.
static bool has_only_sound_triangles(const Scene& scene) {
  const Array<const Triangle> triangles = scene.triangles;
  if (triangles.empty()) return true;
  if (largest_vertex(triangles) >= scene.positions.count) return false;
  if (material_bound(triangles) < scene.materials.count) return true;
  for (std::uint32_t i = 0; i < triangles.count; i = next_material(triangles, i))
    if (triangles[i].material() >= scene.materials.count) return false;
  return true;
}

Status validate_geometry(const Scene& scene) {
  RETURN_IF_ERROR(check_coordinates("positions", scene.positions));
  RETURN_IF_ERROR(check_normals("normals", scene.normals));
  RETURN_IF_ERROR(check_coordinates("uvs", scene.uvs));
  RETURN_IF_ERROR(check_coordinates("second_uvs", scene.second_uvs));
  if (has_only_sound_triangles(scene)) return success();
  std::uint32_t vertex_count = scene.positions.count, material_count = scene.materials.count;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    const Triangle& t = scene.triangles[i];
    for (std::uint32_t vertex : t.vertices())
      if (vertex >= vertex_count) return failure("triangles[%u] has vertex %u of %u", i, vertex, vertex_count);
    if (t.material() >= material_count)
      return failure("triangles[%u] has material %u of %u", i, t.material(), material_count);
  }
  return success();
}

Status validate_material(const Scene& scene, std::uint32_t index) {
  CHECK_LT(index, scene.materials.count);
  RETURN_IF_ERROR(check_material(scene, index));
  return scene.material_maps.count ? validate_maps(scene, index) : success();
}

Status validate_materials(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) RETURN_IF_ERROR(check_material(scene, i));
  for (std::uint32_t i = 0; i < scene.textures.count; ++i) RETURN_IF_ERROR(validate_texture(scene, i));
  return success();
}

Status validate_lights_and_cameras(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.lights.count; ++i) RETURN_IF_ERROR(validate_light(scene, i));
  for (std::uint32_t i = 0; i < scene.cameras.count; ++i) RETURN_IF_ERROR(validate_camera(scene, i));
  if (scene.camera_near.count && scene.camera_near.count != scene.cameras.count)
    return failure("%u camera_near for %u cameras: there must be one for each, or none", scene.camera_near.count,
                   scene.cameras.count);
  for (std::uint32_t i = 0; i < scene.camera_near.count; ++i) {
    const FieldRange distance[] = {{"distance", scene.camera_near[i], 0, kCoordinateMax}};
    RETURN_IF_ERROR(check_fields("camera_near", i, distance));
  }
  return success();
}

static Status validate_origin(const Scene& scene) {
  if (scene.origin.count > 1) return failure("%u origins, not 1", scene.origin.count);
  for (const SceneOrigin& o : scene.origin)
    for (double x : {o.x, o.y, o.z})
      if (!within(Quantity::coordinate, x)) return failure("the origin is not finite or too far away");
  return success();
}

static Status validate_reductions(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.reductions.count; ++i)
    if (static_cast<std::uint32_t>(scene.reductions[i].what) >= static_cast<std::uint32_t>(kInvisibleCount))
      return failure("reductions[%u] is of kind %u, there are %d", i,
                     static_cast<std::uint32_t>(scene.reductions[i].what), kInvisibleCount);
  return success();
}

Status validate_scene(const Scene& scene) {
  RETURN_IF_ERROR(validate_info(scene.info));
  RETURN_IF_ERROR(validate_counts(scene));
  RETURN_IF_ERROR(validate_geometry(scene));
  RETURN_IF_ERROR(validate_materials(scene));
  RETURN_IF_ERROR(validate_glass_maps(scene));
  RETURN_IF_ERROR(validate_material_maps(scene));
  RETURN_IF_ERROR(validate_grains(scene));
  RETURN_IF_ERROR(validate_clear_coats(scene));
  RETURN_IF_ERROR(validate_sheens(scene));
  RETURN_IF_ERROR(validate_iridescences(scene));
  RETURN_IF_ERROR(validate_diffuse_transmissions(scene));
  RETURN_IF_ERROR(validate_lights_and_cameras(scene));
  RETURN_IF_ERROR(validate_default_view(scene));
  RETURN_IF_ERROR(validate_framings(scene));
  RETURN_IF_ERROR(validate_origin(scene));
  RETURN_IF_ERROR(validate_reductions(scene));
  RETURN_IF_ERROR(validate_nodes(scene));
  RETURN_IF_ERROR(validate_animations(scene));
  RETURN_IF_ERROR(validate_moving_meshes(scene));
  RETURN_IF_ERROR(validate_radiosity(scene));
  return validate_environment(scene);
}

}  // namespace pocketray
