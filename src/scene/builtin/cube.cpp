// A closed cube seen from inside, lit by one area light in its ceiling [Bastos92] fig. 6: side 2, about the origin.
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/mesh_writer.h"
#include "scene/builtin/scene_parts.h"

namespace pocketray {
namespace {

// Four walls and a floor of two triangles each, a ceiling around the light, the light.
constexpr MeshSize kSize = {12, 20};
enum MaterialIndex : std::uint32_t { kWhite, kLeft, kRight, kLamp, kMaterialCount };

void add_room(MeshWriter* mesh) {
  constexpr float kLampSide = 0.4f, kLampBack = 0.3f;  // half, and how far behind the middle
  for (int upper = 0; upper < 2; ++upper)
    for (int i = 0; i < 4; ++i)
      add_vertex(mesh, {i == 1 || i == 2 ? 1.0f : -1.0f, upper ? 1.0f : -1.0f, i >= 2 ? 1.0f : -1.0f}, {0, 0, 0});
  for (std::uint32_t i = 0; i < 4; ++i) {
    Vec3 corner = mesh->positions[4 + i];
    add_vertex(mesh, {corner.x * kLampSide, 1, corner.z * kLampSide - kLampBack}, {0, 0, 0});
  }
  mesh->material = kWhite;
  add_triangle(mesh, 0, 2, 1);
  add_triangle(mesh, 0, 3, 2);
  for (std::uint32_t i = 0; i < 4; ++i) {
    std::uint32_t j = (i + 1) % 4;
    mesh->material = i == 1 ? kRight : i == 3 ? kLeft : kWhite;
    add_triangle(mesh, i, j, 4 + j);
    add_triangle(mesh, i, 4 + j, 4 + i);
    mesh->material = kWhite;
    add_triangle(mesh, 4 + i, 4 + j, 8 + j);
    add_triangle(mesh, 4 + i, 8 + j, 8 + i);
  }
  mesh->material = kLamp;
  add_triangle(mesh, 8, 9, 10);
  add_triangle(mesh, 8, 10, 11);
}

}  // namespace

std::size_t cube_need() { return flat_mesh_need(kSize) + parts_need(kMaterialCount, 0, 1); }

void build_cube(Arena* arena, Scene* scene) {
  name_scene(scene, "cube");
  MeshWriter mesh = make_flat_mesh(arena, kSize);
  add_room(&mesh);
  finish_mesh(mesh, scene);
  Array<Material> materials = default_array<Material>(arena, kMaterialCount);
  materials[kWhite] = matte({.75f, .73f, .7f});
  materials[kLeft] = matte({.66f, .36f, .16f});
  materials[kRight] = matte({.2f, .38f, .62f});
  materials[kLamp] = emitter({9, 8.6f, 8}, {.75f, .73f, .7f});
  scene->materials = materials;
  scene->info.ambient = {.16f, .155f, .15f};
  scene->info.exposure = 1;
  set_camera(arena, scene, {.1f, -.32f, .97f}, {-.02f, .02f, -1}, 80);
}

}  // namespace pocketray
