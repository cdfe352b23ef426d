// Grids that are cut apart where something stands on a surface, and what it takes to find that.
#include "desktop/radiosity/grids.h"

#include <doctest/doctest.h>

#include <cmath>

#include "indirect/radiosity.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr float kSide = 4;

void add_sheet(GeneratedScene* s, const Vec3& corner, const Vec3& along, const Vec3& up, std::uint32_t material) {
  add_quad(s, corner, corner + along, corner + along + up, corner + up, material);
}
// A floor on which nothing stands yet, of one-sided material 0; material 1 is two-sided.
std::unique_ptr<GeneratedScene> make_floor() {
  auto s = std::make_unique<GeneratedScene>();
  Material m;
  m.diffuse = {.5f, .5f, .5f}, m.double_sided = 0;
  add_material(s.get(), m);
  m.double_sided = 1;
  add_material(s.get(), m);
  add_sheet(s.get(), {0, 0, 0}, {0, 0, kSide}, {kSide, 0, 0}, 0);
  return s;
}

// The floor's grids, of nodes .1 apart.
struct Floor {
  Surfaces surfaces;
  std::vector<Barrier> barriers;
  Places places;
  RadiositySolution solution;
  Scene scene;

  explicit Floor(const Scene& of) : scene(of) {
    surfaces = find_surfaces(of, 400);
    REQUIRE(surfaces.flat_of[0] != kNone);
    const FlatSurface& flat = surfaces.flat[surfaces.flat_of[0]];
    barriers = find_barriers(of, surfaces, flat, find_cut_edges(of, surfaces), false);
    solution.triangles.assign(of.triangles.count, kNone);
    place_grids(of, flat, barriers, .1, false, &places, &solution);
    solution.view(&scene);
  }
  const RadiosityGrid& grid_at(float x, float z) const { return grid_around(scene, solution.triangles[0], {x, 0, z}); }
  float light_at(float x, float z) const {
    return radiosity_of_grid(scene, grid_at(x, z), {x, 0, z}, Reconstruction::bilinear).x;
  }
};

}  // namespace

// Goal: light on one side of a partition's foot is not that of the other; beyond its end, both sides agree. Method: a
// partition from the border to the middle of a floor, off the lines of a grid; nodes hold the side they lie on.
TEST_CASE("grids_end_at_the_foot_of_a_partition") {
  constexpr float kAt = 1.8765f;
  auto s = make_floor();
  add_sheet(s.get(), {kAt, 0, 0}, {0, 0, 2}, {0, 1, 0}, 1);
  s->bind();
  Floor floor(s->scene);
  REQUIRE(floor.solution.cuts.size() == 1);
  REQUIRE(floor.solution.grids.size() == 2);
  for (const NodePlace& place : floor.places.nodes)
    floor.solution.nodes[place.node].value.x = place.at.point.x < static_cast<double>(kAt) ? 1 : 3;
  join_seams(floor.places.seams, &floor.solution);
  for (float z = .03f; z < 1.85f; z += .1f) {
    CAPTURE(z);
    CHECK(floor.light_at(kAt - 1e-3f, z) == 1);
    CHECK(floor.light_at(kAt + 1e-3f, z) == 3);
  }
  for (float z = 2.15f; z < 3.95f; z += .1f) {
    CAPTURE(z);
    CHECK(std::fabs(floor.light_at(kAt - 1e-5f, z) - floor.light_at(kAt + 1e-5f, z)) < 1e-3f);
  }
}

// Goal: what bars light divides a floor, and nothing else does. Method: sheets close to it or far, from before and
// behind, glass, and edges along its border.
TEST_CASE("barriers_are_what_keeps_light_from_a_floor") {
  auto count = [](const Vec3& corner, const Vec3& along, const Vec3& up, const Material& m) {
    auto s = make_floor();
    const std::uint32_t material = add_material(s.get(), m);
    add_sheet(s.get(), corner, along, up, material);
    s->bind();
    return Floor(s->scene).barriers.size();
  };
  Material two_sided, one_sided, glass;
  one_sided.double_sided = 0, two_sided.double_sided = glass.double_sided = 1, glass.transmission = {1, 1, 1};
  const Vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  CHECK(count({1, 0, 1}, x, y, two_sided) == 1);
  CHECK(count({1, 0, 1}, x, y, one_sided) == 1);
  CHECK(count({1, .01f, 1}, x, y, two_sided) == 1);
  CHECK(count({1, .2f, 1}, x, y, two_sided) == 0);
  CHECK(count({1, 0, 1}, x, y, glass) == 0);
  CHECK(count({1, -1, 1}, x, y, two_sided) == 0);  // below
  CHECK(count({1, 0, 0}, x, y, two_sided) == 0);   // along the border
  CHECK(count({1, .01f, 1}, x, z, two_sided) == 4);
  CHECK(count({1, .01f, 1}, x, z, one_sided) == 4);  // its front faces the floor
  CHECK(count({1, .01f, 1}, z, x, one_sided) == 0);  // its back lets views through
  CHECK(count({1, .2f, 1}, x, z, two_sided) == 0);
}

// Goal: nodes beside a gap keep off its light, those in it show where it ends. Method: a sheet at heights above a
// floor, nodes by their distance from its outline.
TEST_CASE("nodes_keep_off_the_light_of_gaps") {
  for (float gap : {.001f, .01f}) {
    CAPTURE(gap);
    auto s = make_floor();
    add_sheet(s.get(), {1.03f, gap, 1.03f}, {2, 0, 0}, {0, 0, 2}, 1);
    s->bind();
    const Floor floor(s->scene);
    double outside = 1e9, inside = 1e9;
    for (const NodePlace& place : floor.places.nodes) {
      const double off = static_cast<double>(1.03f) - place.at.point.x;
      if (place.at.point.z < 1.2 || place.at.point.z > 2.8) continue;
      double& least = off > 0 ? outside : inside;
      least = std::min(least, std::fabs(off));
    }
    // h/cell of a gap's light is left at about √(h·cell)/2.
    CHECK(outside > .5 * std::sqrt(static_cast<double>(gap) * .1));
    CHECK(outside < 1.2 * std::sqrt(static_cast<double>(gap) * .1));
    CHECK(inside <= .51 * static_cast<double>(gap));
  }
}
