// Bounds and materials of all triangles, which scans of vertices and runs of triangles find.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "base/rng.h"
#include "plan/plan_scene.h"
#include "scene/triangle_scan.h"

using namespace pocketray;

namespace {

Box box_of_triangles(const Scene& scene) {
  Box box = empty_box();
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) box = merge(box, scene.positions[v]);
  return box;
}

struct Cloud {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  Scene scene;
  void bind() {
    scene.positions = {positions.data(), static_cast<std::uint32_t>(positions.size())};
    scene.triangles = {triangles.data(), static_cast<std::uint32_t>(triangles.size())};
  }
};

}  // namespace

// Goal: only vertices that triangles use count. Method: clouds in which outermost vertices are used, unused, or share a
// side with one that is used; vertices in order of first use and not.
TEST_CASE("scene_bounds_are_those_of_triangles") {
  Rng rng = make_rng(601);
  int with_unused = 0;
  for (int i = 0; i < 400; ++i) {
    Cloud cloud;
    const std::uint32_t vertex_count = 3 + next_u32(&rng) % 1200, triangle_count = 1 + next_u32(&rng) % 400;
    for (std::uint32_t v = 0; v < vertex_count; ++v) {
      auto coordinate = [&] { return i % 3 ? next_float(&rng) - 0.5f : static_cast<float>(next_u32(&rng) % 5) - 2; };
      const float x = coordinate(), y = coordinate();
      cloud.positions.push_back({x, y, coordinate()});
    }
    for (std::uint32_t t = 0; t < triangle_count; ++t) {
      auto vertex = [&](std::uint32_t corner) {
        return i % 2 ? (3 * t + corner) % vertex_count : next_u32(&rng) % vertex_count;
      };
      const std::uint32_t a = vertex(0), b = vertex(1);
      cloud.triangles.emplace_back(a, b, vertex(2), 0);
    }
    cloud.bind();
    const Box expected = box_of_triangles(cloud.scene), box = scene_bounds(cloud.scene);
    CAPTURE(i);
    CHECK(box.low == expected.low);
    CHECK(box.high == expected.high);
    Box all = empty_box();
    for (const Vec3& p : cloud.positions) all = merge(all, p);
    with_unused += !(all.low == expected.low && all.high == expected.high);
  }
  CHECK(with_unused > 100);
  CHECK(with_unused < 300);
  CHECK(is_empty(scene_bounds(Scene())));
}

// Goal: scans of triangles agree with loops. Method: materials with numbers of one, two and three shares, in runs.
TEST_CASE("triangle_scans_find_materials_and_vertices") {
  Rng rng = make_rng(602);
  for (int i = 0; i < 60; ++i) {
    std::vector<Triangle> triangles;
    const std::uint32_t materials[] = {next_u32(&rng) % 64, next_u32(&rng) % 4096, next_u32(&rng) % kMaterialCountMax};
    std::uint32_t largest = 0, material = 0, vertex = 0;
    for (int t = 0; t < 200; ++t) {
      if (next_u32(&rng) % 50 == 0) material = materials[next_u32(&rng) % 3];
      const std::uint32_t v = next_u32(&rng) % (t % 50 ? 1000 : kVertexCountMax);
      triangles.emplace_back(0, v, 1, material);
      largest = std::max(largest, material), vertex = std::max(vertex, v);
    }
    const Array<const Triangle> all = {triangles.data(), 200};
    CHECK(material_bound(all) >= largest);
    CHECK(largest_vertex(all) == std::max(vertex, 1u));
    CHECK(any_uses_vertex(all, vertex));
    CHECK(!any_uses_vertex(all, vertex == 2000 ? 2001 : 2000));
    for (std::uint32_t t = 0; t < 200; ++t) {
      std::uint32_t next = t + 1;
      while (next < 200 && triangles[next].material() == triangles[next - 1].material()) ++next;
      CHECK(next_material(all, t) == next);
    }
  }
}
