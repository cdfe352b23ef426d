// Values on triangles that are divided: which parts there are, and what they hold.
#include "desktop/radiosity/corners.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"
#include "indirect/radiosity.h"
#include "radiosity/loose.h"
#include "scene/baked.h"

using namespace pocketray;

namespace {

struct Part {
  Vec3d corner[3];
  std::uint32_t value[3];
};

// The parts of a triangle, from the meaning of splits in scene/radiosity.h.
void add_parts(const RadiositySolution& s, std::uint32_t place, const Part& whole, std::vector<Part>* parts) {
  if (!(place & kRadiositySplitBit)) {
    Part part = whole;
    for (int k = 0; k < 3; ++k) part.value[k] = s.corners[place & kRadiosityPartMax].value[k];
    return parts->push_back(part);
  }
  const std::uint32_t a = place >> 28 & 3;
  const RadiositySplit& split = s.splits[place & kRadiosityPartMax];
  const Vec3d &A = whole.corner[a], &B = whole.corner[(a + 1) % 3], &C = whole.corner[(a + 2) % 3], M = (A + B) * .5;
  add_parts(s, split.part[0], {{A, M, C}, {}}, parts), add_parts(s, split.part[1], {{M, B, C}, {}}, parts);
}

// Gentle hills over columns × rows cells of very unequal sides, with or without normals.
Loose hills(int columns, int rows, bool smooth) {
  Loose scene;
  scene.materials.resize(1);
  Rng rng = make_rng(11);
  auto add_vertex = [&](int column, int row) {
    const float x = static_cast<float>(column * column) * .11f, y = static_cast<float>(row) * 2.3f;
    scene.positions.push_back({x, y, .05f * next_float(&rng)});
    if (smooth) scene.normals.push_back(normalize(Vec3{.1f * next_float(&rng), .1f * next_float(&rng), 1}));
  };
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column) add_vertex(column, row);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t v = static_cast<std::uint32_t>(row * (columns + 1) + column),
                          up = v + static_cast<std::uint32_t>(columns + 1);
      scene.triangles.push_back(Triangle(v, v + 1, up + 1, 0)), scene.triangles.push_back(Triangle(v, up + 1, up, 0));
    }
  return scene;
}

struct Placed {
  RadiositySolution solution;
  Places places;
  std::vector<std::vector<Part>> parts;  // of each triangle
};

Placed place(const Scene& scene, double edge_max) {
  Placed result;
  result.solution.triangles.assign(scene.triangles.count, kNone);
  Surfaces surfaces = find_surfaces(scene, 1);
  surfaces.flat.clear(), surfaces.others.clear();
  for (std::uint32_t t = 0; t < scene.triangles.count; ++t) surfaces.others.push_back(t);
  place_corners(scene, surfaces, edge_max, false, std::vector<char>(scene.triangles.count, 1), &result.places,
                &result.solution);
  for (std::uint32_t t = 0; t < scene.triangles.count; ++t) {
    const std::uint32_t at = result.solution.triangles[t];
    result.parts.emplace_back();
    Part whole = {{corner_of(scene, t, 0), corner_of(scene, t, 1), corner_of(scene, t, 2)}, {}};
    for (std::uint32_t k = 0; k < 3; ++k) whole.value[k] = scene.triangles[t].vertex(k);
    if (at == kRadiosityAtVertices)
      result.parts.back().push_back(whole);
    else
      add_parts(result.solution, at, whole, &result.parts.back());
  }
  return result;
}

}  // namespace

// Goal: no edge of a part is longer than allowed, no corner lies on an edge of another part, and parts that meet share
// their values. Method: hills of triangles up to 20 times as long as wide.
TEST_CASE("divided_triangles_fit_together") {
  for (bool smooth : {false, true}) {
    Loose loose = hills(6, 3, smooth);
    const Scene& scene = loose.bind();
    const Placed placed = place(scene, .7);
    std::vector<Part> all;
    for (const auto& parts : placed.parts) all.insert(all.end(), parts.begin(), parts.end());
    CHECK(all.size() > 4 * scene.triangles.count);
    int shared = 0, wrong = 0;
    for (const Part& part : all)
      for (int k = 0; k < 3; ++k) {
        const Vec3d &a = part.corner[k], &b = part.corner[(k + 1) % 3];
        CHECK(length(b - a) <= .7);
        for (const Part& other : all)
          for (int c = 0; c < 3; ++c) {
            const Vec3d& p = other.corner[c];
            const double along = dot(p - a, b - a) / dot(b - a, b - a);
            const bool inside = along > 1e-6 && along < 1 - 1e-6;
            wrong += inside && length(a + (b - a) * along - p) < 1e-9;
            if (&other == &part || p != a || !smooth) continue;
            ++shared, wrong += other.value[c] != part.value[k];
          }
      }
    CHECK(wrong == 0);
    CHECK((shared > 100) == smooth);
    // Each value is gathered once, at its corner.
    std::vector<int> gathered(placed.solution.values.size());
    for (const ValuePlace& at : placed.places.values) ++gathered[at.value];
    for (const Part& part : all)
      for (int k = 0; k < 3; ++k) {
        CHECK(gathered[part.value[k]] == 1);
        for (const ValuePlace& at : placed.places.values)
          if (at.value == part.value[k]) CHECK(length(at.at.point - part.corner[k]) < .03);
      }
  }
}

// Goal: triangles without long edges keep the values at their vertices or corners and are not divided.
TEST_CASE("small_triangles_are_not_divided") {
  for (bool smooth : {false, true}) {
    Loose loose = hills(6, 3, smooth);
    const Placed placed = place(loose.bind(), 7);
    CHECK(placed.solution.splits.empty());
    CHECK(placed.solution.corners.size() == (smooth ? 0 : loose.triangles.size()));
    for (std::uint32_t at : placed.solution.triangles) CHECK((at == kRadiosityAtVertices) == smooth);
  }
}

// Goal: the descent to a part, and the solver, agree on what lies where. Method: a linear function of the place, stored
// at the parts' corners, is reproduced all over the triangles.
TEST_CASE("divided_triangles_reproduce_linear_functions") {
  Loose loose = hills(5, 2, true);
  Scene scene = loose.bind();
  Placed placed = place(scene, .5);
  auto light = [](const Vec3d& p) { return static_cast<float>(1 + .3 * p.x + .2 * p.y - .7 * p.z); };
  for (const auto& parts : placed.parts)
    for (const Part& part : parts)
      for (int k = 0; k < 3; ++k) placed.solution.values[part.value[k]].x = light(part.corner[k]);
  placed.solution.info.push_back({{99, 99, 99}});
  placed.solution.view(&scene);
  const Status status = validate_scene(scene);
  REQUIRE_MESSAGE(status.ok, status.message);
  const Vec3 any = {0, 0, 0}, white = {1, 1, 1};
  for (std::uint32_t t = 0; t < scene.triangles.count; ++t)
    for (float u = 0; u <= 1; u += .0625f)
      for (float v = 0; u + v <= 1; v += .0625f) {
        const Vec3d p = corner_of(scene, t, 0) * static_cast<double>(1 - u - v) +
                        corner_of(scene, t, 1) * static_cast<double>(u) +
                        corner_of(scene, t, 2) * static_cast<double>(v);
        const Vec3 value = RadiosityIndirect::radiance({scene, nullptr, any, any, white, t, u, v});
        CHECK(std::fabs(value.x - light(p)) < 1e-5f);
      }
}

// Goal: what lies inside a body takes its light from what does not. Method: a furnace, in which light arrives
// everywhere with 1; a pole ends in a box.
TEST_CASE("poles_in_a_furnace_are_evenly_lit_to_their_ends") {
  Loose furnace;
  furnace.materials.resize(1);
  furnace.materials[0].diffuse = furnace.materials[0].emission = {.5f, .5f, .5f};
  furnace.materials[0].double_sided = 0;
  auto add_box = [&](const Vec3& low, const Vec3& high, bool inward) {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        auto corner = [&](int s, int t) {
          Vec3 p = low;
          p[axis] = side ? high[axis] : low[axis];
          if (s) p[(axis + 1) % 3] = high[(axis + 1) % 3];
          if (t) p[(axis + 2) % 3] = high[(axis + 2) % 3];
          return p;
        };
        const bool turn = (side == 0) != inward;
        furnace.add(corner(0, 0), corner(turn ? 0 : 1, turn ? 1 : 0), corner(1, 1));
        furnace.add(corner(0, 0), corner(1, 1), corner(turn ? 1 : 0, turn ? 0 : 1));
      }
  };
  add_box({-2, -2, 0}, {2, 2, 4}, true);
  add_box({-1, -1, 0}, {1, 1, 1}, false);
  const std::size_t pole = furnace.positions.size();
  const Vec3 foot[3] = {{.03f, 0, .1f}, {0, .03f, .1f}, {-.03f, -.03f, .1f}}, up = {0, 0, 3.7f};
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = foot[k], &b = foot[(k + 1) % 3];
    furnace.add(a, b, b + up), furnace.add(a, b + up, a + up);
  }
  furnace.normals.resize(furnace.positions.size(), Vec3{0, 0, 0});
  for (std::size_t v = pole; v < furnace.positions.size(); ++v)  // round, so that it has no grids
    furnace.normals[v] = normalize(Vec3{furnace.positions[v].x, furnace.positions[v].y, 0});
  RadiositySolution solution;
  REQUIRE(solve(furnace.bind(), 200, &solution).ok);
  CHECK(solution.splits.size() > 6 * 4);
  for (const RadiosityCorners& corners : solution.corners)
    for (std::uint32_t value : corners.value) CHECK(std::fabs(solution.values[value].x - 1) < 2e-3f);
}
