#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <string>

#include "builtin_helpers.h"
#include "scene/baked.h"

using namespace pocketray;

namespace {

using Point = std::array<float, 3>;
Point point(const Vec3& p) { return {p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}; }  // -0 becomes 0

// Directed edges between distinct positions, opposite ones cancelled: empty for a closed surface.
std::map<std::pair<Point, Point>, int> open_edges(const Scene& scene) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const Triangle& t : scene.triangles) {
    for (int i = 0; i < 3; ++i) {
      Point a = point(scene.positions[t.vertex(i)]), b = point(scene.positions[t.vertex((i + 1) % 3)]);
      if (a == b) continue;
      if (a < b)
        ++edges[{a, b}];
      else
        --edges[{b, a}];
    }
  }
  for (auto i = edges.begin(); i != edges.end();) i = i->second == 0 ? edges.erase(i) : std::next(i);
  return edges;
}

Vec3 area_vector(const Scene& scene, const Triangle& t) {
  Vec3 a = scene.positions[t.vertex(0)];
  return cross(scene.positions[t.vertex(1)] - a, scene.positions[t.vertex(2)] - a);
}

}  // namespace

// Goal: the triangle counts given by the papers. Method: count.
TEST_CASE("builtin_triangle_counts_are_the_papers") {
  const std::map<std::string, std::uint32_t> expected = {{"cornell", 45109}, {"statue", 67244}, {"seesaw", 6000},
                                                         {"cube", 20},       {"furnace", 24},   {"lanterns", 26358}};
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(std::string(list[i].name));
    REQUIRE(expected.count(list[i].name) == 1);
    CHECK(shared_builtin(list[i])->scene.triangles.count == expected.at(list[i].name));
    CHECK(find_builtin(list[i].name) == &list[i]);
  }
  CHECK(find_builtin("cornel") == nullptr);
}

// Goal: build() takes exactly need(), and its result passes the checks for hostile files. Method: measure the arena.
TEST_CASE("builtin_need_is_exact_and_the_scene_is_valid") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(std::string(list[i].name));
    const BuiltScene* built = shared_builtin(list[i]);
    CHECK(built->arena.used_max == list[i].need());
    CHECK(built->arena.used <= list[i].need());
    Status status = validate_scene(built->scene);
    CHECK_MESSAGE(status.ok, status.message);
  }
}

// Goal: closed things are closed; only the Cornell box is open, in front. Method: every edge is used as often in one
// direction as in the other, vertices compared by position.
TEST_CASE("builtin_surfaces_are_closed_but_for_the_front_of_the_cornell_box") {
  for (const char* name : {"cube", "furnace"}) {
    CAPTURE(std::string(name));
    CHECK(open_edges(shared_builtin(name)->scene).empty());
  }
  const BuiltScene* cornell = shared_builtin("cornell");
  auto edges = open_edges(cornell->scene);
  CHECK(edges.size() == 5);  // the floor's front edge is halved
  for (const auto& edge : edges) {
    CHECK(edge.first.first[2] == 0);
    CHECK(edge.first.second[2] == 0);
  }
}

// Goal: shading normals are unit, or zero for flat faces, and lie on the side of the geometric normal. Method: all
// corners; in the statue's finest folds, at most 1 triangle in 100 may have a corner normal off by more than a right
// angle.
TEST_CASE("builtin_normals_are_unit_and_on_the_front") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(std::string(list[i].name));
    const BuiltScene* built = shared_builtin(list[i]);
    const Scene& scene = built->scene;
    int not_unit = 0, behind = 0, degenerate = 0;
    for (const Vec3& n : scene.normals) not_unit += !is_zero(n) && std::fabs(length(n) - 1) > 1e-6f;
    for (const Triangle& t : scene.triangles) {
      Vec3 area = area_vector(scene, t);
      degenerate += is_zero(area);
      for (std::uint32_t v : t.vertices()) {
        if (scene.normals.count && dot(area, scene.normals[v]) < 0) {
          ++behind;
          break;
        }
      }
    }
    CHECK(not_unit == 0);
    CHECK(degenerate == 0);
    CHECK(behind <= static_cast<int>(scene.triangles.count / 100));
  }
}

// Goal: cornell's sphere takes any number of columns within the stated memory, and cornell itself is one of them.
// Method: count triangles; the sphere's facets are mirrors, and the finer they are, the closer they lie to the sphere.
TEST_CASE("builtin_cornell_is_tessellated_as_asked") {
  const BuiltScene* cornell = shared_builtin("cornell");
  double sag_before = 1e9;
  for (std::uint32_t columns : {8u, 16u, kCornellSphereColumns, 128u}) {
    CAPTURE(columns);
    std::vector<std::uint8_t> block(tessellated_cornell_need(columns) + kArenaAlignment);
    Arena arena = make_arena("cornell", block.data(), block.size());
    Scene scene;
    build_tessellated_cornell(columns, &arena, &scene);
    CHECK(arena.used <= tessellated_cornell_need(columns));
    if (columns == kCornellSphereColumns) CHECK(baked_size(scene) == baked_size(cornell->scene));
    CHECK((scene.triangles.count == cornell->scene.triangles.count) == (columns == kCornellSphereColumns));
    double sag = 0;
    for (const Triangle& t : scene.triangles) {
      if (is_zero(scene.materials[t.material()].mirror)) continue;
      Vec3 middle =
          (scene.positions[t.vertex(0)] + scene.positions[t.vertex(1)] + scene.positions[t.vertex(2)]) * (1 / 3.0f);
      sag = std::max(sag, 88 - static_cast<double>(length(middle - Vec3{158, 88, 190})));
    }
    CHECK(sag > 0);
    CHECK(sag < 0.5 * sag_before);
    sag_before = sag;
  }
}
