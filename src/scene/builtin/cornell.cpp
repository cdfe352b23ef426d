// The Cornell box as measured by the Program of Computer Graphics, Cornell University ("The Cornell Box", data of
// 1998): geometry in millimetres as published, the walls not quite square. Red is on the left and green on the right,
// because the camera looks along +z with x growing to the left. A statue and a mirror sphere replace the two blocks,
// after [Aranha07] figs. 2, 3.
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/figure.h"
#include "scene/builtin/mesh_writer.h"
#include "scene/builtin/scene_parts.h"

namespace pocketray {
namespace {

constexpr MeshSize kRoomSize = {17, 19};
constexpr FigureDetail kFigure = {113, 164, 31, 34, 23};
// Makes facets about as high as wide.
constexpr std::uint32_t sphere_rows(std::uint32_t columns) { return (9 * columns + 8) / 16; }
constexpr MeshSize size_of(std::uint32_t sphere_columns) {
  return kRoomSize + box_size() + sphere_size(sphere_columns, sphere_rows(sphere_columns)) + figure_size(kFigure);
}
static_assert(size_of(kCornellSphereColumns).triangles == 45109, "[Aranha07] sec. 4");

enum MaterialIndex : std::uint32_t { kWhite, kRed, kGreen, kLamp, kMarble, kMirror, kMaterialCount };

void add_room(MeshWriter* mesh) {
  constexpr Vec3 kFloor[4] = {{552.8f, 0, 0}, {0, 0, 0}, {0, 0, 559.2f}, {549.6f, 0, 559.2f}};
  constexpr Vec3 kCeiling[4] = {{556, 548.8f, 0}, {0, 548.8f, 0}, {0, 548.8f, 559.2f}, {556, 548.8f, 559.2f}};
  constexpr Vec3 kLight[4] = {{343, 548.8f, 227}, {213, 548.8f, 227}, {213, 548.8f, 332}, {343, 548.8f, 332}};
  std::uint32_t floor = mesh->vertex_count;
  for (const Vec3& corner : kFloor) add_vertex(mesh, corner, {0, 0, 0});
  std::uint32_t ceiling = mesh->vertex_count;
  for (const Vec3& corner : kCeiling) add_vertex(mesh, corner, {0, 0, 0});
  std::uint32_t light = mesh->vertex_count;
  for (const Vec3& corner : kLight) add_vertex(mesh, corner, {0, 0, 0});
  // Halving the open front edge of the floor gives the number of triangles in the paper.
  std::uint32_t middle = add_vertex(mesh, {276.4f, 0, 0}, {0, 0, 0});

  mesh->material = kWhite;
  add_triangle(mesh, middle, floor + 1, floor + 2);
  add_triangle(mesh, middle, floor + 2, floor + 3);
  add_triangle(mesh, middle, floor + 3, floor);
  for (std::uint32_t i = 0; i < 4; ++i) {  // the ceiling has a hole, filled by the light
    std::uint32_t j = (i + 1) % 4;
    add_triangle(mesh, ceiling + i, light + j, ceiling + j);
    add_triangle(mesh, ceiling + i, light + i, light + j);
  }
  add_triangle(mesh, floor + 2, ceiling + 3, floor + 3);
  add_triangle(mesh, floor + 2, ceiling + 2, ceiling + 3);
  mesh->material = kGreen;
  add_triangle(mesh, floor + 1, ceiling + 2, floor + 2);
  add_triangle(mesh, floor + 1, ceiling + 1, ceiling + 2);
  mesh->material = kRed;
  add_triangle(mesh, floor + 3, ceiling, floor);
  add_triangle(mesh, floor + 3, ceiling + 3, ceiling);
  mesh->material = kLamp;
  add_quad(mesh, kLight[0], kLight[3], kLight[2], kLight[1]);
}

Transform turned(float radians_about_y, const Vec3& to) {
  double half = 0.5 * static_cast<double>(radians_about_y);
  return compose(to, {0, static_cast<float>(det_sin(half)), 0, static_cast<float>(det_cos(half))}, {1, 1, 1});
}

}  // namespace

std::size_t cornell_need() { return tessellated_cornell_need(kCornellSphereColumns); }
void build_cornell(Arena* arena, Scene* scene) { build_tessellated_cornell(kCornellSphereColumns, arena, scene); }

std::size_t tessellated_cornell_need(std::uint32_t sphere_columns) {
  return mesh_need(size_of(sphere_columns)) + parts_need(kMaterialCount, 0, 1);
}

void build_tessellated_cornell(std::uint32_t sphere_columns, Arena* arena, Scene* scene) {
  name_scene(scene, "cornell");
  MeshWriter mesh = make_mesh(arena, size_of(sphere_columns));
  add_room(&mesh);
  const float turn = 3.45f;  // towards the camera and the light
  const Vec3 place = {362, 0, 335};
  mesh.material = kWhite;
  add_box(&mesh, {-72, 0, -72}, {72, 48, 72}, turned(turn, place));
  mesh.material = kMarble;
  add_figure(&mesh, kFigure, place + Vec3{0, 48, 0}, 52, turn);
  mesh.material = kMirror;
  add_sphere(&mesh, {158, 88, 190}, {88, 88, 88}, sphere_columns, sphere_rows(sphere_columns));
  finish_mesh(mesh, scene);

  // The measured spectra converted to linear sRGB; the light is the published one, white-balanced half-way like the
  // photograph.
  Array<Material> materials = default_array<Material>(arena, kMaterialCount);
  materials[kWhite] = matte({.725f, .71f, .68f});
  materials[kRed] = matte({.63f, .065f, .05f});
  materials[kGreen] = matte({.14f, .45f, .091f});
  materials[kLamp] = emitter({18.4f, 14.4f, 8.6f}, {.78f, .78f, .78f});
  materials[kMarble] = glossy({.74f, .72f, .68f}, {.06f, .06f, .06f}, 24);
  materials[kMirror] = matte({0, 0, 0});
  materials[kMirror].mirror = {.9f, .9f, .9f};
  scene->materials = materials;
  scene->info.ambient = {.075f, .058f, .036f};
  scene->info.exposure = 3.1f;
  set_camera(arena, scene, {278, 273, -800}, {278, 273, 0}, 39.3);
}

}  // namespace pocketray
