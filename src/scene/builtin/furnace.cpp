// The furnace: a closed room in which every surface emits Le = 0.5 and reflects ρ = 0.5 diffusely. Full interreflection
// makes the radiance Le/(1 − ρ) = 1 everywhere, so the block in the room disappears; after n reflections it is
// Le·(1 − ρⁿ⁺¹)/(1 − ρ), and Le without indirect and area light (HARDCASES row 49).
#include "scene/builtin/builtin_scenes.h"
#include "scene/builtin/mesh_writer.h"
#include "scene/builtin/scene_parts.h"

namespace pocketray {
namespace {

constexpr MeshSize kSize = 2 * box_size();

}  // namespace

std::size_t furnace_need() { return flat_mesh_need(kSize) + parts_need(1, 0, 1); }

void build_furnace(Arena* arena, Scene* scene) {
  name_scene(scene, "furnace");
  MeshWriter mesh = make_flat_mesh(arena, kSize);
  add_box(&mesh, {-1, -1, -1}, {1, 1, 1});
  for (Triangle& t : mesh.triangles) {  // the room is seen from inside
    if (&t == mesh.triangles.data + mesh.triangle_count) break;
    std::uint32_t swap = t.vertex(1);
    t.set_vertex(1, t.vertex(2));
    t.set_vertex(2, swap);
  }
  Quaternion tilt = {.2f, .4f, .1f, .88881944f};
  add_box(&mesh, {-.3f, -.3f, -.3f}, {.3f, .3f, .3f}, compose({.1f, -.2f, -.2f}, tilt, {1, 1, 1}));
  finish_mesh(mesh, scene);
  Array<Material> materials = default_array<Material>(arena, 1);
  materials[0] = emitter({.5f, .5f, .5f}, {.5f, .5f, .5f});
  scene->materials = materials;
  set_camera(arena, scene, {0, 0, .95f}, {0, -.05f, -1}, 70);
}

}  // namespace pocketray
