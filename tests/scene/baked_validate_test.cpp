// Every rule of validate_scene(): a scene that violates it is refused, and the message names the element.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>

#include "base/limits.h"
#include "scene/baked.h"
#include "scene/full_scene.h"
#include "scene/refusals.h"
#include "scene/texel_blocks.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

template <class E>
E unknown(int value) {
  return static_cast<E>(value);
}

}  // namespace

// Goal: HARDCASES row 8: invalid coordinates and indices never get in. Method: each kind in each array.
TEST_CASE("hard_08_vertices_and_indices_out_of_range_are_refused") {
  count_assertions("refused, saying why");
  for (float bad : {kNan, -kNan, kInf, -kInf, 1.0001e18f, -2e18f, 3e38f}) {
    refuses("positions[13]", [=](FullScene* f) { f->positions[13].z = bad; });
    refuses("normals[4]", [=](FullScene* f) { f->normals[4].y = bad; });
    refuses("uvs[2]", [=](FullScene* f) { f->uvs[2].x = bad; });
    refuses("rest_positions[5]", [=](FullScene* f) { f->rest_positions[5].x = bad; });
    refuses("rest_normals[0]", [=](FullScene* f) { f->rest_normals[0].x = bad; });
    refuses("morph_positions[7]", [=](FullScene* f) { f->morph_positions[7].x = bad; });
    refuses("morph_normals[7]", [=](FullScene* f) { f->morph_normals[7].z = bad; });
    refuses("key_values[3]", [=](FullScene* f) { f->key_values[3] = bad; });
    refuses("key_times[1]", [=](FullScene* f) { f->key_times[1] = bad; });
    refuses("weights[1]", [=](FullScene* f) { f->weights[1] = bad; });
    refuses("joints[1]", [=](FullScene* f) { f->joints[1].inverse_bind.m[2][3] = bad; });
    refuses("moving_meshes[1]", [=](FullScene* f) { f->moving_meshes[1].instance.m[2][3] = bad; });
    refuses("nodes[1]", [=](FullScene* f) { f->nodes[1].translation.y = bad; });
    refuses("nodes[2]", [=](FullScene* f) { f->nodes[2].scale.y = bad; });
    refuses("nodes[0]", [=](FullScene* f) { f->nodes[0].rotation.w = bad; });
  }
  accepts([](FullScene* f) { f->positions[0] = {1e18f, -1e18f, 1e-45f}; });
  for (int corner = 0; corner < 3; ++corner)
    refuses("triangles[5]", [=](FullScene* f) { f->triangles[5].set_vertex(corner, 14); });
  refuses("triangles[0]", [](FullScene* f) { f->triangles[0].set_vertex(1, kVertexCountMax - 1); });
  refuses("triangles[2]", [](FullScene* f) { f->triangles[2].set_material(3); });
}

// Goal: HARDCASES row 27: singular and overflowing transforms are refused, naming the node. Method: determinants 0,
// below the smallest normal float, infinite; tiny and huge ones inside the range are accepted.
TEST_CASE("hard_27_singular_nodes_are_refused_by_name") {
  count_assertions("refused by name");
  accepts([](FullScene* f) { f->nodes[2].scale = {1, 0, 1}; });  // hidden: HARDCASES row 70
  refuses("nodes[2]", [](FullScene* f) { f->nodes[2].scale = {1e-19f, 1e-19f, 1}; });
  refuses("nodes[1]", [](FullScene* f) { f->nodes[1].scale = {1e17f, 1e17f, 1e17f}; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].instance.m[0][0] = 0; });
  accepts([](FullScene* f) { f->nodes[2].scale = {1e-12f, -1e-12f, 1e-12f}; });
  accepts([](FullScene* f) { f->nodes[2].scale = {1e12f, 1e12f, -1e12f}; });
}

// Goal: array sizes agree with each other and with the limits.
TEST_CASE("validate_scene_refuses_counts_that_do_not_fit") {
  refuses("13 normals for 14 vertices", [](FullScene* f) { f->normals.pop_back(); });
  refuses("13 uvs for 14 vertices", [](FullScene* f) { f->uvs.pop_back(); });
  refuses("15 colors for 14 vertices", [](FullScene* f) { f->colors.push_back({0, 0, 0, 0}); });
  refuses("cameras", [](FullScene* f) { f->cameras.resize(kCameraCountMax + 1); });
  refuses("lights", [](FullScene* f) { f->lights.resize(kLightCountMax + 1); });
  refuses("nodes", [](FullScene* f) { f->nodes.resize(kNodeCountMax + 1); });
  refuses("textures", [](FullScene* f) { f->textures.resize(kTextureCountMax + 1); });
  refuses("materials", [](FullScene* f) { f->materials.resize(kMaterialCountMax + 1); });
  refuses("rest_normals", [](FullScene* f) { f->rest_normals.pop_back(); });
  refuses("rest_normals", [](FullScene* f) { f->rest_normals.clear(); });
  refuses("rest_normals", [](FullScene* f) { f->normals.clear(); });
  refuses("morph_normals", [](FullScene* f) { f->morph_normals.pop_back(); });
  accepts(
      [](FullScene* f) { f->normals.clear(), f->rest_normals.clear(), f->morph_normals.clear(), f->colors.clear(); });
}

// Goal: the scene's general numbers are checked.
TEST_CASE("validate_scene_refuses_bad_info") {
  refuses("name", [](FullScene* f) {
    for (char& c : f->scene.info.name) c = 'x';
  });
  refuses("frame_count", [](FullScene* f) { f->scene.info.frame_count = 0; });
  refuses("default_lights", [](FullScene* f) { f->scene.info.default_lights = 2; });
  refuses("default", [](FullScene* f) { f->scene.info.default_camera = 2; });
  for (float bad : {kNan, kInf, -1.0f}) {
    refuses("background.y", [=](FullScene* f) { f->scene.info.background.y = bad; });
    refuses("ambient.x", [=](FullScene* f) { f->scene.info.ambient.x = bad; });
    refuses("exposure", [=](FullScene* f) { f->scene.info.exposure = bad; });
    refuses("frames_per_second", [=](FullScene* f) { f->scene.info.frames_per_second = bad; });
    refuses("auto_exposure", [=](FullScene* f) { f->scene.info.auto_exposure = bad; });
  }
  refuses("exposure", [](FullScene* f) { f->scene.info.exposure = 0; });
}

// Goal: materials that would gain energy, or with invalid references, are refused. HARDCASES row 31: exponents up to
// 10^6.
TEST_CASE("validate_scene_refuses_bad_materials") {
  for (float bad : {kNan, kInf, -0.001f, 1.001f}) {
    refuses("materials[1].diffuse.x", [=](FullScene* f) { f->materials[1].diffuse.x = bad; });
    refuses("materials[0].specular.y", [=](FullScene* f) { f->materials[0].specular.y = bad; });
    refuses("materials[1].mirror.z", [=](FullScene* f) { f->materials[1].mirror.z = bad; });
    refuses("materials[1].transmission.x", [=](FullScene* f) { f->materials[1].transmission.x = bad; });
    refuses("materials[1].roughness", [=](FullScene* f) { f->materials[1].roughness = bad; });
    refuses("materials[1].grazing", [=](FullScene* f) { f->materials[1].grazing = bad; });
    refuses("materials[1].specular_tinted.x", [=](FullScene* f) { f->materials[1].specular_tinted.x = bad; });
    refuses("materials[1].mirror_tinted.y", [=](FullScene* f) { f->materials[1].mirror_tinted.y = bad; });
    refuses("materials[1].opacity", [=](FullScene* f) { f->materials[1].opacity = bad; });
  }
  for (float bad : {kNan, kInf, -1.0f}) {
    refuses("materials[1].emission.x", [=](FullScene* f) { f->materials[1].emission.x = bad; });
    refuses("materials[1].absorption.y", [=](FullScene* f) { f->materials[1].absorption.y = bad; });
    refuses("materials[1].alpha_cutoff", [=](FullScene* f) { f->materials[1].alpha_cutoff = bad; });
    refuses("materials[1].exponent", [=](FullScene* f) { f->materials[1].exponent = bad; });
    refuses("materials[1].ior", [=](FullScene* f) { f->materials[1].ior = bad; });
  }
  refuses("materials[1].exponent", [](FullScene* f) { f->materials[1].exponent = 1.01e6f; });
  refuses("materials[1].ior", [](FullScene* f) { f->materials[1].ior = 0.99f; });
  refuses("materials[1].brdf", [](FullScene* f) { f->materials[1].brdf = kBrdfCountMax; });
  refuses("alpha mode", [](FullScene* f) { f->materials[0].alpha_mode = unknown<AlphaMode>(3); });
  refuses("0 or 1", [](FullScene* f) { f->materials[0].double_sided = 2; });
  refuses("0 or 1", [](FullScene* f) { f->materials[0].unlit = 255; });
  refuses("unlit", [](FullScene* f) { f->materials[1].unlit = 1; });
  refuses("0 or 1", [](FullScene* f) { f->materials[0].thin = 2; });
  refuses("materials[1].diffuse_texture", [](FullScene* f) { f->materials[1].diffuse_texture.texture = 2; });
  refuses("materials[0].emission_texture", [](FullScene* f) { f->materials[0].emission_texture.texture = 2; });
  refuses("materials[0].diffuse_texture", [](FullScene* f) { f->materials[0].diffuse_texture.m[1][2] = kNan; });
  refuses("needs uvs", [](FullScene* f) { f->uvs.clear(); });
  accepts([](FullScene* f) {
    f->materials[1].exponent = 1e6f, f->materials[1].ior = 1, f->materials[1].diffuse = {1, 1, 0};
  });
}

// Goal: maps that would leave their bounds, or with invalid references, are refused, and so are maps of materials that
// kernels would not ask for them. Method: each field in turn.
TEST_CASE("validate_scene_refuses_bad_material_maps") {
  for (float bad : {kNan, kInf, -0.001f, 1.001f}) {
    refuses("material_maps[2].base.x", [=](FullScene* f) { f->material_maps[2].model.base.x = bad; });
    refuses("material_maps[2].dielectric.z", [=](FullScene* f) { f->material_maps[2].model.dielectric.z = bad; });
    refuses("material_maps[2].grazing", [=](FullScene* f) { f->material_maps[2].model.grazing = bad; });
    refuses("material_maps[2].metallic", [=](FullScene* f) { f->material_maps[2].metallic = bad; });
    refuses("material_maps[0].roughness", [=](FullScene* f) { f->material_maps[0].roughness = bad; });
    refuses("material_maps[2].metallic_low", [=](FullScene* f) { f->material_maps[2].metallic_low = bad; });
    refuses("material_maps[2].metallic_high", [=](FullScene* f) { f->material_maps[2].metallic_high = bad; });
    refuses("material_maps[2].roughness_low", [=](FullScene* f) { f->material_maps[2].roughness_low = bad; });
    refuses("material_maps[2].roughness_high", [=](FullScene* f) { f->material_maps[2].roughness_high = bad; });
  }
  for (float bad : {kNan, kInf, -1001.0f}) {
    refuses("material_maps[1].normal_scale", [=](FullScene* f) { f->material_maps[1].normal_scale = bad; });
    refuses("material_maps[2].occlusion_strength", [=](FullScene* f) { f->material_maps[2].occlusion_strength = bad; });
    refuses("material_maps[2].normal has a transform",
            [=](FullScene* f) { f->material_maps[2].normal.m[0][0] = bad * 1e30f; });
  }
  refuses("normal is texture 9 of 2", [](FullScene* f) { f->material_maps[0].normal.texture = 9; });
  refuses("specular is texture 3 of 2", [](FullScene* f) { f->material_maps[2].specular.texture = 3; });
  refuses("specular_color is texture 2 of 2", [](FullScene* f) { f->material_maps[1].specular_color.texture = 2; });
  refuses("transmits", [](FullScene* f) { f->material_maps[1].specular_color.texture = 1; });
  refuses("occlusion is texture 2 of 2", [](FullScene* f) { f->material_maps[0].occlusion.texture = 2; });
  refuses("metallic_low", [](FullScene* f) { f->material_maps[2].metallic_low = 0.8f; });
  refuses("is texture 2 of 2", [](FullScene* f) { f->material_maps[2].metallic_roughness.texture = 2; });
  refuses("not finite", [](FullScene* f) { f->material_maps[0].metallic_roughness.m[0][1] = kInf; });
  refuses("one for each", [](FullScene* f) { f->material_maps.pop_back(); });
  refuses("transmits", [](FullScene* f) { f->materials[2].transmission.y = 0.5f; });
  refuses("unlit", [](FullScene* f) { f->materials[2].unlit = 1, f->materials[2].specular = {0, 0, 0}; });
  refuses("has none", [](FullScene* f) { f->materials[2].specular = {0, 0, 0}; });
  accepts([](FullScene* f) { f->material_maps.clear(); });
}

// Goal: a grain stronger than 1, or with an invalid texture, is refused.
TEST_CASE("validate_scene_refuses_bad_grains") {
  for (float bad : {kNan, kInf, 1.01f, -2.0f}) {
    refuses("grains[2].direction", [=](FullScene* f) { f->grains[2].direction.x = bad; });
    refuses("grains[0].direction", [=](FullScene* f) { f->grains[0].direction.y = bad; });
  }
  refuses("grains[1].texture is texture 7 of 2", [](FullScene* f) { f->grains[1].texture.texture = 7; });
  refuses("grains[2].texture has a transform", [](FullScene* f) { f->grains[2].texture.m[1][2] = kInf; });
  refuses("one for each", [](FullScene* f) { f->grains.pop_back(); });
  refuses("tangents", [](FullScene* f) { f->tangents.pop_back(); });
  accepts([](FullScene* f) { f->tangents[0] = {-128, -128, 5, 9}; });
  accepts([](FullScene* f) { f->tangents.clear(); });
  accepts([](FullScene* f) { f->grains.clear(); });
  accepts([](FullScene* f) { f->grains[0].direction = {0.70710678f, -0.70710678f}; });
}

TEST_CASE("validate_scene_refuses_bad_default_views") {
  refuses("2 default_views", [](FullScene* f) { f->default_view.push_back({}); });
  refuses("default_view[0].is_room is 2", [](FullScene* f) { f->default_view[0].is_room = 2; });
  refuses("default_view[0].side is 4 of 4", [](FullScene* f) { f->default_view[0].side = 4; });
  for (float bad : {kNan, kInf, -0.5f, 1.5f})
    refuses("default_view[0].inside_share", [=](FullScene* f) { f->default_view[0].inside_share = bad; });
  for (float bad : {kNan, kInf, 0.1f, 2.0f})
    refuses("default_view[0].opening", [=](FullScene* f) { f->default_view[0].opening.y = bad; });
  accepts([](FullScene* f) { f->default_view[0].opening = {0, 0, 0}; });
  accepts([](FullScene* f) { f->default_view.clear(); });
}

TEST_CASE("validate_scene_refuses_bad_framings") {
  refuses("2 framings for ", [](FullScene* f) { f->framings.push_back({}); });
  refuses("framings[0].backward", [](FullScene* f) { f->framings[0].backward.z = 0.7f; });
  for (float bad : {kNan, kInf, 1e19f}) {
    refuses("framings[0] stands", [=](FullScene* f) { f->framings[0].eye.y = bad; });
    refuses("framings[0] stands", [=](FullScene* f) { f->framings[0].target.z = bad; });
    refuses("framings[0].reach", [=](FullScene* f) { f->framings[0].reach[3][15] = bad; });
  }
  accepts([](FullScene* f) { f->framings[0].reach[2][0] = -3e18f; });
  accepts([](FullScene* f) { f->framings.clear(); });
}

// Goal: a texture of the second coordinates finds them, finite, one at each vertex; a normal map has the first ones,
// whose frame is its own. Method: each wrong in turn.
TEST_CASE("validate_scene_refuses_bad_second_uvs") {
  refuses("13 second_uvs for 14 vertices", [](FullScene* f) { f->second_uvs.pop_back(); });
  refuses("15 second_uvs for 14 vertices", [](FullScene* f) { f->second_uvs.push_back({0, 0}); });
  for (float bad : {kNan, kInf, -kInf, 2e18f}) {
    refuses("second_uvs[3]", [=](FullScene* f) { f->second_uvs[3].x = bad; });
    refuses("second_uvs[13]", [=](FullScene* f) { f->second_uvs[13].y = bad; });
  }
  refuses("textures[0] reads texture coordinates 2", [](FullScene* f) { f->textures[0].uv_set = 2; });
  refuses("textures[1] reads texture coordinates 255", [](FullScene* f) { f->textures[1].uv_set = 255; });
  refuses("materials[1].emission_texture needs second_uvs", [](FullScene* f) { f->second_uvs.clear(); });
  refuses("needs uvs", [](FullScene* f) { f->uvs.clear(), f->textures[0].uv_set = 1; });
  refuses("material_maps[2].normal reads second_uvs", [](FullScene* f) { f->textures[0].uv_set = 1; });
  auto only = [](TextureUse MaterialMaps::*use) {
    return [=](FullScene* f) {
      f->textures.push_back(f->textures[1]);
      f->textures[1].uv_set = 0, f->material_maps[2].*use = TextureUse(), (f->material_maps[2].*use).texture = 2;
      f->second_uvs.clear();
    };
  };
  refuses("material_maps[2].metallic_roughness needs second_uvs", only(&MaterialMaps::metallic_roughness));
  refuses("material_maps[2].occlusion needs second_uvs", only(&MaterialMaps::occlusion));
  refuses("material_maps[2].specular needs second_uvs", only(&MaterialMaps::specular));
  refuses("material_maps[2].specular_color needs second_uvs", only(&MaterialMaps::specular_color));
  refuses("grains[2].texture needs second_uvs", [](FullScene* f) {
    f->textures.push_back(f->textures[1]);
    f->textures[1].uv_set = 0, f->grains[2].texture.texture = 2, f->second_uvs.clear();
  });
  accepts([](FullScene* f) { f->textures[1].uv_set = 0; });  // there are coordinates that nothing reads
  accepts([](FullScene* f) { f->textures[1].uv_set = 0, f->second_uvs.clear(); });
}

// Goal: no texel outside the array is ever fetched.
TEST_CASE("validate_scene_refuses_bad_textures") {
  refuses("textures[0]", [](FullScene* f) { f->textures[0].width = 0; });
  refuses("textures[1]", [](FullScene* f) { f->textures[1].height = 0; });
  refuses("textures[1]", [](FullScene* f) { f->textures[1].height = 5; });
  refuses("textures[1]", [](FullScene* f) { f->textures[1].texel_begin = 8; });
  refuses("textures[0]", [](FullScene* f) { f->textures[0].texel_begin = kNone; });
  refuses("textures[0]", [](FullScene* f) { f->textures[0].width = kTextureSideMax + 1; });
  refuses("textures[0]", [](FullScene* f) { f->textures[0].wrap_u = unknown<Wrap>(3); });
  refuses("textures[0]", [](FullScene* f) { f->textures[0].wrap_v = unknown<Wrap>(255); });
  refuses("textures[0]", [](FullScene* f) { f->textures[0].nearest = 2; });
  refuses("textures[0] of 3 by 2 texels has 0 levels", [](FullScene* f) { f->textures[0].level_count = 0; });
  refuses("has 3 levels, it must have 1 to 2", [](FullScene* f) { f->textures[0].level_count = 3; });
  refuses("has 255 levels", [](FullScene* f) { f->textures[1].level_count = 255; });
  refuses("textures[1] extends beyond", [](FullScene* f) { f->texels.pop_back(); });  // its last level
  accepts([](FullScene* f) { f->textures[1].level_count = 2, f->texels.pop_back(); });
  refuses("textures[0] is of an unknown format", [](FullScene* f) { f->textures[0].format = unknown<TexelFormat>(7); });
  refuses("textures[1] is of an unknown format", [](FullScene* f) { f->textures[1].reserved[1] = 1; });
  for (int format = 1; format < kTexelFormatCount; ++format) {
    const auto blocks = static_cast<TexelFormat>(format);
    const std::uint32_t words = level_words(blocks, 1, 4, 3);
    auto resize = [=](FullScene* f, std::uint32_t count) {
      f->textures[1].format = blocks, f->texels.resize(f->textures[1].texel_begin + count);
    };
    accepts([=](FullScene* f) { resize(f, words); });
    refuses("textures[1] extends beyond", [=](FullScene* f) { resize(f, words - 1); });
  }
}

// Goal: lights and cameras that would give NaN are refused. HARDCASES row 28.
TEST_CASE("hard_28_degenerate_lights_and_cameras_are_refused") {
  count_assertions("refused, saying why");
  refuses("lights[2]", [](FullScene* f) { f->lights[2].kind = unknown<LightKind>(3); });
  refuses("lights[0]", [](FullScene* f) { f->lights[0].node = 3; });
  refuses("lights[1].position", [](FullScene* f) { f->lights[1].position.x = kInf; });
  refuses("lights[1].direction", [](FullScene* f) { f->lights[1].direction = {0, 0, 0}; });
  refuses("lights[1].direction", [](FullScene* f) { f->lights[1].direction = {0, 1.2f, 0}; });
  refuses("lights[1].cos_outer", [](FullScene* f) { f->lights[1].cos_outer = 0.95f; });
  refuses("lights[1].cos_inner", [](FullScene* f) { f->lights[1].cos_inner = 1.5f; });
  for (float bad : {kNan, kInf, -1.0f}) {
    refuses("lights[0].intensity.z", [=](FullScene* f) { f->lights[0].intensity.z = bad; });
    refuses("lights[0].range", [=](FullScene* f) { f->lights[0].range = bad; });
    refuses("cameras[0].vertical_fov", [=](FullScene* f) { f->cameras[0].vertical_fov = bad; });
    refuses("cameras[1].vertical_extent", [=](FullScene* f) { f->cameras[1].vertical_extent = bad; });
  }
  refuses("cameras[0].vertical_fov", [](FullScene* f) { f->cameras[0].vertical_fov = 3.15f; });
  refuses("cameras[0].vertical_fov", [](FullScene* f) { f->cameras[0].vertical_fov = 0; });
  refuses("cameras[1].vertical_extent", [](FullScene* f) { f->cameras[1].vertical_extent = 0; });
  refuses("cameras[0]", [](FullScene* f) { f->cameras[0].target = f->cameras[0].eye; });
  refuses("cameras[0].up", [](FullScene* f) { f->cameras[0].up = {0, 0, 0}; });
  refuses("cameras[0]", [](FullScene* f) { f->cameras[0].eye.x = kNan; });
  refuses("cameras[1]", [](FullScene* f) { f->cameras[1].projection = unknown<Projection>(2); });
  refuses("cameras[1]", [](FullScene* f) { f->cameras[1].node = 3; });
  refuses("nothing is animated", [](FullScene* f) { f->animations.clear(), f->cameras[1].node = kNone; });
  refuses("nothing is animated", [](FullScene* f) { f->animations.clear(), f->lights[0].node = kNone; });
}

// Goal: a pose never reads outside an array and always terminates.
TEST_CASE("validate_scene_refuses_bad_nodes_and_channels") {
  refuses("nodes[0]", [](FullScene* f) { f->nodes[0].parent = 0; });
  refuses("nodes[1]", [](FullScene* f) { f->nodes[1].parent = 2; });
  refuses("nodes[1]", [](FullScene* f) { f->nodes[1].rotation = {0, 0, 0, 0}; });
  refuses("nodes[2]", [](FullScene* f) { f->nodes[2].weight_count = 3; });
  refuses("nodes[2]", [](FullScene* f) { f->nodes[2].weight_begin = kNone; });
  refuses("morph weights, at most", [](FullScene* f) {
    f->nodes[2].weight_count = kMorphTargetCountMax + 1, f->weights.resize(kMorphTargetCountMax + 1);
  });
  refuses("channels[1]", [](FullScene* f) { f->channels[1].node = 3; });
  refuses("channels[0]", [](FullScene* f) { f->channels[0].path = unknown<ChannelPath>(kChannelPathCount); });
  refuses("channels[0]", [](FullScene* f) { f->channels[0].interpolation = unknown<Interpolation>(3); });
  refuses("channels[2]", [](FullScene* f) { f->channels[2].key_count = 0; });
  refuses("channels[2]", [](FullScene* f) { f->channels[2].key_begin = 2; });
  refuses("animation keys", [](FullScene* f) { f->channels[2].key_count = kNone; });
  refuses("channels[0]", [](FullScene* f) { f->channels[0].value_begin = 10; });
  refuses("channels[3]", [](FullScene* f) { f->channels[3].value_begin = kNone - 1; });
  refuses("channels[2]", [](FullScene* f) { f->channels[2].node = 0; });  // has no weights
  refuses("channels[0]", [](FullScene* f) { f->key_times[2] = f->key_times[1]; });
  refuses("channels[0]", [](FullScene* f) { f->key_times[0] = -1; });
  refuses("animations[1]", [](FullScene* f) { f->animations[1].channel_count = 20; });
  refuses("animations[1]", [](FullScene* f) { f->animations[1].channel_begin = kNone; });
  for (float bad : {kNan, kInf, -1.0f})
    refuses("animations[0]", [=](FullScene* f) { f->animations[0].duration = bad; });
  refuses("channels[5] changes light", [](FullScene* f) { f->channels[5].node = 9; });
  refuses("channels[7] changes camera", [](FullScene* f) { f->channels[7].node = 9; });
  refuses("channels[8] changes material", [](FullScene* f) { f->channels[8].node = kNone; });
  refuses("2 animation_labels", [](FullScene* f) { f->animation_labels.pop_back(); });
  refuses("animation_labels[1]", [](FullScene* f) { f->animation_labels[1].combines = 2; });
  refuses("2 node_visible", [](FullScene* f) { f->node_visible.pop_back(); });
  refuses("node_visible[2]", [](FullScene* f) { f->node_visible[2] = 2; });
  refuses("2 origins", [](FullScene* f) { f->origin.push_back({}); });
  for (double bad : {static_cast<double>(kNan), static_cast<double>(kInf), 1e19})
    refuses("origin", [=](FullScene* f) { f->origin[0].y = bad; });
  accepts([](FullScene* f) { f->animation_labels.clear(), f->node_visible.clear(), f->origin.clear(); });
}

TEST_CASE("validate_scene_refuses_bad_skins_and_moving_meshes") {
  refuses("joints[0]", [](FullScene* f) { f->joints[0].node = 3; });
  refuses("skins[0]", [](FullScene* f) { f->skins[0].joint_count = 3; });
  refuses("skins[0]", [](FullScene* f) { f->skins[0].joint_count = 0; });
  refuses("skins[0]", [](FullScene* f) { f->skins[0].joint_begin = kNone; });
  refuses("skin_weights[3]", [](FullScene* f) { f->skin_weights[3].joint[3] = 2; });
  refuses("skin_weights[1]", [](FullScene* f) { f->skin_weights[1].weight[0] = 0.5f; });
  refuses("skin_weights[1]", [](FullScene* f) { f->skin_weights[1].weight[2] = kNan; });
  refuses("skin_weights[1]", [](FullScene* f) { f->skin_weights[1] = {{0, 1, 0, 0}, {-1, 2, 0, 0}}; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].vertex_begin = 9; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].vertex_count = 5; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].vertex_count = kNone; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].rest_begin = 3; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].node = kNone; });
  refuses("moving_meshes[0]", [](FullScene* f) { f->moving_meshes[0].node = kNone; });  // its morph needs weights
  refuses("moving_meshes[0]", [](FullScene* f) { f->moving_meshes[0].skin = 1; });
  refuses("moving_meshes[0]", [](FullScene* f) { f->moving_meshes[0].skin_weight_begin = 1; });
  refuses("moving_meshes[0]", [](FullScene* f) { f->moving_meshes[0].morph_begin = 1; });
  refuses("moving_meshes[0]", [](FullScene* f) { f->moving_meshes[0].morph_count = 3; });
  refuses("moving_meshes[1]", [](FullScene* f) { f->moving_meshes[1].morph_count = 1; });
  accepts([](FullScene* f) { f->moving_meshes[0].morph_count = 0, f->moving_meshes[0].node = kNone; });
}
