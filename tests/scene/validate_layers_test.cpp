// Rules of validate_scene() for coats, sheens, thin films, leaves and textures of glass.
#include "scene/refusals.h"

using namespace pocketray;

// Goal: a clear coat out of range, with an invalid texture, over an unlit material or with normals of the second
// coordinates is refused.
TEST_CASE("validate_scene_refuses_bad_clear_coats") {
  for (float bad : {kNan, kInf, 1.01f, -0.5f}) {
    refuses("clear_coats[1].strength", [=](FullScene* f) { f->clear_coats[1].strength = bad; });
    refuses("clear_coats[0].roughness", [=](FullScene* f) { f->clear_coats[0].roughness = bad; });
    refuses("clear_coats[1].roughness_low", [=](FullScene* f) { f->clear_coats[1].roughness_low = bad; });
  }
  for (float bad : {kNan, kInf, 1e5f})
    refuses("clear_coats[2].normal_scale", [=](FullScene* f) { f->clear_coats[2].normal_scale = bad; });
  refuses("clear_coats[1].roughness_low", [](FullScene* f) { f->clear_coats[1].roughness = 0.125f; });
  refuses("clear_coats[0].roughness_low is 0 without a texture", [](FullScene* f) { f->clear_coats[0].roughness = 1; });
  refuses("clear_coats[1].strength_texture is texture 7 of 2",
          [](FullScene* f) { f->clear_coats[1].strength_texture.texture = 7; });
  refuses("clear_coats[2].roughness_texture has a transform",
          [](FullScene* f) { f->clear_coats[2].roughness_texture.m[0][1] = kNan; });
  refuses("clear_coats[0].normal is texture 2 of 2", [](FullScene* f) { f->clear_coats[0].normal.texture = 2; });
  refuses("clear_coats[1].normal reads second_uvs", [](FullScene* f) { f->clear_coats[1].normal.texture = 1; });
  refuses("clear_coats[0] coats materials[0], which is unlit",
          [](FullScene* f) { f->materials[0].unlit = 1, f->clear_coats[0].strength = 1; });
  refuses("one for each", [](FullScene* f) { f->clear_coats.pop_back(); });
  accepts([](FullScene* f) { f->clear_coats.clear(); });
  accepts([](FullScene* f) { f->materials[0].unlit = 1; });
}

// Goal: a sheen out of range, with an invalid texture or over an unlit material is refused.
TEST_CASE("validate_scene_refuses_bad_sheens") {
  for (float bad : {kNan, kInf, 1.01f, -0.5f}) {
    refuses("sheens[1].color.x", [=](FullScene* f) { f->sheens[1].color.x = bad; });
    refuses("sheens[0].color.z", [=](FullScene* f) { f->sheens[0].color.z = bad; });
    refuses("sheens[0].roughness", [=](FullScene* f) { f->sheens[0].roughness = bad; });
    refuses("sheens[1].roughness_low", [=](FullScene* f) { f->sheens[1].roughness_low = bad; });
  }
  refuses("sheens[1].roughness_low", [](FullScene* f) { f->sheens[1].roughness = 0.125f; });
  refuses("sheens[0].roughness_low is 0 without a texture", [](FullScene* f) { f->sheens[0].roughness = 1; });
  refuses("sheens[1].color_texture is texture 7 of 2", [](FullScene* f) { f->sheens[1].color_texture.texture = 7; });
  refuses("sheens[2].roughness_texture has a transform",
          [](FullScene* f) { f->sheens[2].roughness_texture.m[0][1] = kNan; });
  refuses("sheens[0] covers materials[0], which is unlit", [](FullScene* f) {
    f->materials[0].unlit = 1, f->sheens[0].color = {1, 0, 0};
  });
  refuses("one for each", [](FullScene* f) { f->sheens.pop_back(); });
  accepts([](FullScene* f) { f->sheens.clear(); });
}

// Goal: a map of glass out of range, with an invalid texture, without the maps of lobes or of an opaque material is
// refused.
TEST_CASE("validate_scene_refuses_bad_glass_maps") {
  for (float bad : {kNan, kInf, 1.01f, -0.5f})
    refuses("glass_maps[1].transmission", [=](FullScene* f) { f->glass_maps[1].transmission = bad; });
  for (float bad : {kNan, kInf, -0.5f})
    refuses("glass_maps[0].thickness", [=](FullScene* f) { f->glass_maps[0].thickness = bad; });
  refuses("glass_maps[0].transmission_texture is texture 7 of 2",
          [](FullScene* f) { f->glass_maps[0].transmission_texture.texture = 7; });
  refuses("glass_maps[1].thickness_texture has a transform",
          [](FullScene* f) { f->glass_maps[1].thickness_texture.m[0][1] = kNan; });
  refuses("glass_maps[1] needs material_maps",
          [](FullScene* f) { f->material_maps.clear(), f->glass_maps[1].transmission = 0.5f; });
  refuses("glass_maps[1] transmits light, but materials[1] does not", [](FullScene* f) {
    f->glass_maps[1].transmission = 0.5f;
    f->material_maps[1].model.base = {1, 1, 1}, f->material_maps[1].metallic_low = 0;
    f->materials[1].transmission = {0, 0, 0};
  });
  refuses("one for each", [](FullScene* f) { f->glass_maps.pop_back(); });
  accepts([](FullScene* f) { f->glass_maps.clear(); });
}

// Goal: a thin film out of range, with an invalid texture or over an unlit material is refused.
TEST_CASE("validate_scene_refuses_bad_films") {
  for (float bad : {kNan, kInf, 1.01f, -0.5f})
    refuses("iridescences[1].strength", [=](FullScene* f) { f->iridescences[1].strength = bad; });
  for (float bad : {kNan, kInf, 0.9f})
    refuses("iridescences[0].ior", [=](FullScene* f) { f->iridescences[0].ior = bad; });
  for (float bad : {kNan, kInf, -1.0f}) {
    refuses("iridescences[0].thickness_low", [=](FullScene* f) { f->iridescences[0].thickness_low = bad; });
    refuses("iridescences[2].thickness_high", [=](FullScene* f) { f->iridescences[2].thickness_high = bad; });
  }
  refuses("iridescences[1].strength_texture is texture 7 of 2",
          [](FullScene* f) { f->iridescences[1].strength_texture.texture = 7; });
  refuses("iridescences[2].thickness_texture has a transform",
          [](FullScene* f) { f->iridescences[2].thickness_texture.m[0][1] = kNan; });
  refuses("iridescences[0] covers materials[0], which is unlit",
          [](FullScene* f) { f->materials[0].unlit = 1, f->iridescences[0].strength = 1; });
  refuses("one for each", [](FullScene* f) { f->iridescences.pop_back(); });
  accepts([](FullScene* f) { f->iridescences.clear(); });
}

// Goal: diffuse transmission out of range, with an invalid texture or of an unlit material is refused.
TEST_CASE("validate_scene_refuses_bad_diffuse_transmission") {
  for (float bad : {kNan, kInf, 1.01f, -0.5f}) {
    refuses("diffuse_transmissions[1].strength", [=](FullScene* f) { f->diffuse_transmissions[1].strength = bad; });
    refuses("diffuse_transmissions[0].color.y", [=](FullScene* f) { f->diffuse_transmissions[0].color.y = bad; });
  }
  refuses("diffuse_transmissions[1].strength_texture is texture 7 of 2",
          [](FullScene* f) { f->diffuse_transmissions[1].strength_texture.texture = 7; });
  refuses("diffuse_transmissions[2].color_texture has a transform",
          [](FullScene* f) { f->diffuse_transmissions[2].color_texture.m[0][1] = kNan; });
  refuses("diffuse_transmissions[0] belongs to materials[0], which is unlit",
          [](FullScene* f) { f->materials[0].unlit = 1, f->diffuse_transmissions[0].strength = 1; });
  refuses("one for each", [](FullScene* f) { f->diffuse_transmissions.pop_back(); });
  accepts([](FullScene* f) { f->diffuse_transmissions.clear(); });
}
