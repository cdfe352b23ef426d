#include <doctest/doctest.h>
#include <cstring>

#include "scene/baked.h"

using namespace pocketray;

// Goal: a triangle of 12 bytes holds any valid vertices and material, and setting one changes no other. Method: all
// combinations of the smallest, the largest and one in between.
TEST_CASE("triangle_keeps_all_vertices_and_materials_there_may_be") {
  static_assert(sizeof(Triangle) == 12, "three words");
  const std::uint32_t vertices[] = {0, 0x2AAAAAA, kVertexCountMax - 1};
  const std::uint32_t materials[] = {0, 0x5A5A, kMaterialCountMax - 1};
  auto holds = [](const Triangle& t, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
    return t.vertex(0) == a && t.vertex(1) == b && t.vertex(2) == c && t.material() == material &&
           t.vertices() == std::array<std::uint32_t, 3>{{a, b, c}};
  };
  for (std::uint32_t a : vertices)
    for (std::uint32_t b : vertices)
      for (std::uint32_t c : vertices)
        for (std::uint32_t material : materials) {
          Triangle t(a, b, c, material);
          CHECK(holds(t, a, b, c, material));
          for (std::uint32_t other : materials) {
            t.set_material(other);
            CHECK(holds(t, a, b, c, other));
          }
          t.set_vertex(0, c), t.set_vertex(2, a);
          CHECK(holds(t, c, b, a, materials[2]));
        }
}

// Goal: a scene with more vertices than triangles can reference is refused with a message about vertices. Method:
// counts only; they are checked before the arrays.
TEST_CASE("validate_refuses_more_vertices_than_a_triangle_can_name") {
  Vec3 point = {0, 0, 0};
  Scene scene;
  scene.positions = {&point, kVertexCountMax + 1};
  Status status = validate_scene(scene);
  CHECK_FALSE(status.ok);
  CHECK(std::strstr(status.message, "vertices") != nullptr);
}
