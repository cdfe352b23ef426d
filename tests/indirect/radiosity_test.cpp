// Stored radiosity: where it is looked up, and what the plan makes of it.
#include "indirect/radiosity.h"

#include <doctest/doctest.h>

#include "effect/setting_list.h"
#include "indirect/indirect_list.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// A unit square of two triangles with a grid in front, values of its own at the back of the first.
struct Stored {
  Vec3 positions[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  Triangle triangles[2] = {Triangle(0, 1, 2, 0), Triangle(0, 2, 3, 0)};
  RadiosityInfo info = {{4, 4, 4}};
  std::uint32_t places[4] = {kRadiosityGridBit, kRadiosityAtVertices, 0, kNone};
  RadiosityGrid grid = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2, 0};
  RadiosityNode nodes[4] = {};
  RadiosityCorners corners = {{0, 1, 1}};
  Vec3 values[4] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  Scene scene;
  Stored() {
    for (int i = 0; i < 4; ++i) nodes[i].value = Vec3{1, 1, 1} * static_cast<float>(i);  // s + 2t, and flat tangents
    scene.positions = {positions, 4}, scene.triangles = {triangles, 2};
    scene.radiosity_info = {&info, 1}, scene.radiosity_triangles = {places, 4};
    scene.radiosity_grids = {&grid, 1}, scene.radiosity_nodes = {nodes, 4};
    scene.radiosity_corners = {&corners, 1}, scene.radiosity_values = {values, 4};
  }
  float at(std::uint32_t triangle, float u, float v, bool front, Reconstruction how) const {
    const Vec3 any = {0, 0, 0}, half = {.5f, .5f, .5f};
    return RadiosityIndirect::radiance({scene, nullptr, any, any, half, triangle, u, v, front, how}).x;
  }
};

}  // namespace

// Goal: a hit finds the light of its triangle, side and place. Method: a grid, vertices, corners and nothing, each with
// every reconstruction.
TEST_CASE("radiosity_is_looked_up_by_triangle_side_and_place") {
  const Stored s;
  using R = Reconstruction;
  CHECK(s.at(0, .25f, .5f, true, R::bilinear) == doctest::Approx(.5 * (.75 + 2 * .5)));
  CHECK(s.at(0, .25f, .5f, true, R::constant) == doctest::Approx(.5 * 1.5));
  // Flat tangents make 3t² − 2t³ of each coordinate.
  const double x = 3 * .75 * .75 - 2 * .75 * .75 * .75;
  CHECK(s.at(0, .25f, .5f, true, R::bicubic) == doctest::Approx(.5 * (x + 2 * .5)));
  CHECK(s.at(1, .25f, .5f, true, R::bilinear) == doctest::Approx(.5 * (.25 * 2 + .5 * 3)));
  CHECK(s.at(1, .25f, .5f, true, R::constant) == doctest::Approx(.5 * 5 / 3));
  CHECK(s.at(0, .25f, .5f, false, R::bilinear) == doctest::Approx(.5 * .75));
  CHECK(s.at(1, .25f, .5f, false, R::bilinear) == 0);
  Stored fronts;
  fronts.scene.radiosity_triangles.count = 2;
  CHECK(fronts.at(0, .25f, .5f, false, R::bilinear) == 0);
}

// Goal: a hit on a flat part that is cut apart finds the grid on its side of each line. Method: two cuts, three grids
// of one value each, points on either side of the lines.
TEST_CASE("radiosity_of_cut_grids_is_that_of_their_side") {
  Stored s;
  RadiosityGrid grids[3] = {s.grid, s.grid, s.grid};
  RadiosityNode nodes[12] = {};
  for (int i = 0; i < 12; ++i) nodes[i].value = Vec3{1, 1, 1} * static_cast<float>(1 + i / 4);
  for (std::uint32_t i = 0; i < 3; ++i) grids[i].node_begin = 4 * i;
  const RadiosityCut cuts[2] = {{{.5f, 0, 0}, {1, 0, 0}, {kRadiosityGridBit, kRadiosityCutBits | 1}},
                                {{0, .25f, 0}, {0, 1, 0}, {kRadiosityGridBit | 1, kRadiosityGridBit | 2}}};
  s.places[0] = kRadiosityCutBits;
  s.scene.radiosity_grids = {grids, 3}, s.scene.radiosity_nodes = {nodes, 12}, s.scene.radiosity_cuts = {cuts, 2};
  // The place in the square is (u + v, v).
  for (Reconstruction how : {Reconstruction::constant, Reconstruction::bilinear, Reconstruction::bicubic}) {
    CHECK(s.at(0, .3f, .1f, true, how) == .5f);
    CHECK(s.at(0, .45f, .04f, true, how) == .5f);
    CHECK(s.at(0, .5f, .01f, true, how) == 1);
    CHECK(s.at(0, .5f, .24f, true, how) == 1);
    CHECK(s.at(0, .5f, .26f, true, how) == 1.5f);
  }
}

// Goal: a hit on a divided triangle finds the part around it. Method: ABC halved on BC, and the half with B on its edge
// to A; values that are linear in each part, against barycentric weights by areas.
TEST_CASE("radiosity_of_divided_triangles_is_that_of_the_part") {
  Stored s;
  const Vec2 places[5] = {{0, 0}, {1, 0}, {0, 1}, {.5f, .5f}, {.5f, 0}};  // A, B, C, M of BC, N of AB, as (u, v)
  const Vec3 values[5] = {{1, 0, 0}, {2, 0, 0}, {4, 0, 0}, {7, 0, 0}, {1.5f, 0, 0}};
  // B M A and M C A; then the edge AB, from the third of B M A to its first.
  const RadiosityCorners corners[3] = {{{3, 2, 0}}, {{0, 4, 3}}, {{4, 1, 3}}};
  const std::uint32_t turn = kRadiosityTurnShift;
  const RadiositySplit splits[2] = {{{kRadiositySplitBit | 2u << turn | 1, 0}}, {{1u | 1u << kRadiosityLevelShift, 2}}};
  s.places[1] = kRadiositySplitBit | 1u << turn;
  s.info.value_max = {8, 8, 8};
  s.scene.radiosity_corners = {corners, 3}, s.scene.radiosity_values = {values, 5};
  s.scene.radiosity_splits = {splits, 2};
  auto area = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  int parts = 0;
  for (float u = .0625f; u < 1; u += .125f)
    for (float v = .03125f; u + v < 1; v += .0625f)
      for (const RadiosityCorners& part : corners) {
        const Vec2 &a = places[part.value[0]], &b = places[part.value[1]], &c = places[part.value[2]], p = {u, v};
        const float whole = area(a, b, c), x = area(p, b, c) / whole, y = area(a, p, c) / whole, z = 1 - x - y;
        if (x < 0 || y < 0 || z < 0) continue;
        ++parts;
        const float wanted = x * values[part.value[0]].x + y * values[part.value[1]].x + z * values[part.value[2]].x;
        CHECK(s.at(1, u, v, true, Reconstruction::bicubic) == doctest::Approx(.5 * static_cast<double>(wanted)));
      }
  CHECK(parts > 40);
}

// Goal: Phong's lobe reflects stored light as a diffuse surface of its mean albedo, and GGX's by its own albedo; an
// unlit material does not, nor a lobe that is switched off.
TEST_CASE("radiosity_is_reflected_by_glossy_lobes") {
  Stored s;
  const Vec3 any = {0, 0, 0};
  IndirectPoint at = {s.scene, nullptr, any, any, any, 1, .25f, .5f};
  at.glossy = {.3f, .6f, 0};
  const Vec3 value = RadiosityIndirect::radiance(at);
  CHECK(value.x == doctest::Approx(.2 * (.25 * 2 + .5 * 3)));
  CHECK(value.y == doctest::Approx(.4 * (.25 * 2 + .5 * 3)));
  Material material;
  material.diffuse = {.25f, .25f, .25f}, material.specular = {.3f, .3f, .3f}, material.exponent = 20;
  CHECK(RadiosityIndirect::bound(s.scene, material) == doctest::Approx(.45 * 4));
  material.brdf = kGgx;
  CHECK(RadiosityIndirect::bound(s.scene, material) == doctest::Approx(.25 * 4));

  for (std::uint32_t& place : s.places) place = kRadiosityAtVertices;
  for (Vec3& stored : s.values) stored = {1, 1, 1};
  s.scene.materials = {&material, 1};
  Light dark;  // no default lights
  dark.position = {0, 0, -1}, s.scene.lights = {&dark, 1};
  Settings settings;
  settings.width = settings.height = 4, settings.indirect = indirect_choice(Effect::radiosity);
  auto seen = [&](std::uint32_t brdf, bool unlit, EffectMask off) {
    material.brdf = brdf, material.unlit = unlit, settings.forced_off = off;
    auto test = make_renderer(s.scene, settings);
    REQUIRE(begin_frame(&test->renderer, {0}).ok);
    return trace_ray(test->renderer, {.5f, .25f, 1}, {0, 0, -1}).x;
  };
  CHECK(seen(kPhong, false, 0) == doctest::Approx(.45));
  CHECK(seen(kPhong, false, bit(Effect::specular)) == doctest::Approx(.25));
  CHECK(seen(kPhong, true, 0) == doctest::Approx(.25));
  const BrdfAlbedo albedo = kBrdfList[kGgx]->albedo(material, material.specular, 1);
  CHECK(seen(kGgx, false, bit(Effect::ambient_gloss)) == doctest::Approx(.25));
  CHECK(seen(kGgx, false, 0) == doctest::Approx(double(.25f + albedo.once.x + albedo.scattered.x)));
}

// Goal: no value leaves [0, the stored maximum], which the cut-off relies on. Method: tangents that overshoot both
// ways.
TEST_CASE("radiosity_stays_within_its_bound") {
  Stored s;
  Material material;
  material.diffuse = {.5f, .25f, .5f};
  CHECK(RadiosityIndirect::bound(s.scene, material) == 2);
  for (RadiosityNode& n : s.nodes) n.ds = {40, -40, 0};
  const Vec3 any = {0, 0, 0};
  for (float u = 0; u <= 1; u += .125f) {
    const Vec3 value = RadiosityIndirect::radiance({s.scene, nullptr, any, any, material.diffuse, 0, u, (1 - u) / 2});
    for (int axis = 0; axis < 3; ++axis) CHECK((value[axis] >= 0 && value[axis] <= 2));
  }
  CHECK(RadiosityIndirect::bound(Scene(), material) == 0);
}
