// Stored light on surfaces that emit, in the rendered pixel: HARDCASES rows 49 and 72.
#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "radiosity/loose.h"
#include "scene/builtin_helpers.h"
#include "support/hard_case.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

// Picture of a scene with the light that the solver stores for it.
std::vector<Vec3> baked_picture(Scene scene, std::uint32_t patches) {
  RadiositySolution solution;
  const Status status = solve(scene, patches, &solution);
  REQUIRE_MESSAGE(status.ok, status.message);
  solution.view(&scene);
  Settings settings;
  settings.width = 16, settings.height = 12;
  return render_picture(scene, settings);
}

double worst_error(const std::vector<Vec3>& picture, double expected) {
  double worst = 0;
  for (const Vec3& p : picture)
    for (int axis = 0; axis < 3; ++axis)
      worst = std::fmax(worst, std::fabs(static_cast<double>(p[axis]) / expected - 1));
  return worst;
}

Material grey_lamp(float emission, float albedo) {
  Material m;
  m.diffuse = {albedo, albedo, albedo}, m.emission = {emission, emission, emission};
  m.double_sided = 0;
  return m;
}

}  // namespace

// Goal: the furnace keeps its promise in the picture: every pixel shows Le/(1 − ρ) = 1. Method: the built-in scene,
// solved and rendered.
TEST_CASE("hard_49_stored_light_in_the_rendered_pixel") {
  count_assertions("1e-3 of Le/(1 − ρ)");
  auto built = build_builtin("furnace");
  const std::vector<Vec3> picture = baked_picture(built->scene, 300);
  REQUIRE(picture.size() == 16 * 12);
  CHECK(worst_error(picture, 1) < 1e-3);
}

// Goal: emitters of one material light each other: a closed box shows Le/(1 − ρ). Method: all walls of one material,
// and of two that are alike.
TEST_CASE("hard_72_emitters_of_one_material_light_each_other") {
  count_assertions("1e-3 of Le/(1 − ρ)");
  for (float albedo : {.5f, .8f, .95f}) {
    CAPTURE(albedo);
    GeneratedScene s;
    add_box(&s, {-1, -1, -1}, {1, 1, 1}, add_material(&s, grey_lamp(1, albedo)), true);
    aim(&s, {.3f, .1f, .9f}, {0, -.1f, -1}, 70);
    s.bind();
    CHECK(worst_error(baked_picture(s.scene, 300), 1 / (1 - static_cast<double>(albedo))) < 1e-3);
  }
}

// Returns the radiance of the square lamp of the next test: its emission of 4 and half of its irradiance from the
// floor, which likewise emits 4 and reflects half. Sums over points of both, with the lamp's radiance taken as uniform.
double lamp_between_itself_and_floor() {
  constexpr int kLamp = 8, kFloor = 160;
  auto at = [](int i, int count, double size) { return ((i + .5) / count - .5) * size; };
  double of_floor = 0, of_lamp = 0;  // what the lamp gets per light of the floor, and of its own by way of the floor
  for (int f = 0; f < kFloor * kFloor; ++f) {
    const double x = at(f % kFloor, kFloor, 10), z = at(f / kFloor, kFloor, 10);
    double seen = 0;  // mean of cos cos / (π r²) over the lamp
    for (int l = 0; l < kLamp * kLamp; ++l) {
      const double dx = x - at(l % kLamp, kLamp, 1), dz = z - at(l / kLamp, kLamp, 1), square = dx * dx + dz * dz + 1;
      seen += 1 / (kPi * square * square) / (kLamp * kLamp);
    }
    const double area = 100.0 / (kFloor * kFloor);
    of_floor += seen * area, of_lamp += .5 * seen * seen * area;
  }
  return (4 + .5 * 4 * of_floor) / (1 - .5 * of_lamp);
}

// Goal: a floor that emits reflects the light of a lamp of its own material above it, as of any other, and the lamp
// reflects the floor's. Method: unit square at height 1 over the middle of the floor, form factor .2394565 (HARDCASES
// row 37); both materials by turns.
TEST_CASE("hard_72_lamp_over_a_floor_of_its_own_material") {
  count_assertions("1 % of the lamp's light");
  for (bool own : {true, false}) {
    CAPTURE(own);
    GeneratedScene s;
    const std::uint32_t floor = add_material(&s, grey_lamp(4, .5f)),
                        lamp = own ? floor : add_material(&s, grey_lamp(4, .5f));
    add_quad(&s, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}, floor);
    add_quad(&s, {-.5f, 1, -.5f}, {.5f, 1, -.5f}, {.5f, 1, .5f}, {-.5f, 1, .5f}, lamp);
    aim(&s, {0, .5f, 0}, {0, 0, .001f}, 1);
    s.bind();
    const double light = lamp_between_itself_and_floor() * .5 * .2394565;
    for (const Vec3& p : baked_picture(s.scene, 1200))
      CHECK(static_cast<double>(p.x) - 4 == doctest::Approx(light).epsilon(.01));
  }
}

// Goal: a small lamp above a floor under the open sky, which hardly a ray meets, spoils no factors: the lamp reflects
// light of the floor back to it. Method: light of the floor's nodes below the lamp by its solid angle: what the floor
// sends up, ρ E / π, times the lamp's reflectance, times the factors of both directions, summed over the floor.
TEST_CASE("a_small_lamp_under_the_open_sky_is_solved") {
  GeneratedScene s;
  Material m;
  m.diffuse = {.5f, .5f, .5f}, m.double_sided = 0;
  const std::uint32_t floor = add_material(&s, m);
  m.emission = {100, 100, 100};
  const std::uint32_t lamp = add_material(&s, m);
  add_quad(&s, {0, 0, 0}, {0, 0, 4}, {4, 0, 4}, {4, 0, 0}, floor);
  add_quad(&s, {1.98f, 2, 1.98f}, {2.02f, 2, 1.98f}, {2.02f, 2, 2.02f}, {1.98f, 2, 2.02f}, lamp);
  s.bind();
  RadiositySolution solution;
  REQUIRE(solve(s.scene, 400, &solution).ok);
  float most = 0;
  for (const RadiosityNode& node : solution.nodes) most = std::max(most, node.value.x);
  // The lamp of area A at height h: E = L A h² / r⁴ at distance r; it gets ∫ ρ E h² / (π² r⁴), and sends ρ of it back.
  const double area = .04 * .04, h = 2;
  double arrives = 0;
  const int side = 400;
  for (int i = 0; i < side * side; ++i) {
    const double x = (i % side + .5) * 4 / side - 2, z = (i / side + .5) * 4 / side - 2, square = x * x + z * z + h * h;
    arrives += .5 * 100 * area * h * h / (square * square) * h * h / (kPi * kPi * square * square) * 16 / side / side;
  }
  const double below = .5 * arrives * area / (kPi * h * h);
  MESSAGE(most, ", by closed form ", below);
  CHECK(std::fabs(static_cast<double>(most) / below - 1) < .1);
}

// Goal: a floor gets the light of the sky that its window shows, not the sky's mean, and every node about the same.
// Method: a dark room whose ceiling has a hole, under a sky that is bright overhead; the floor below the hole by
// the sum over it.
TEST_CASE("rooms_get_the_sky_that_their_windows_show") {
  GeneratedScene s;
  Material m;
  m.diffuse = {.5f, .5f, .5f}, m.specular = {0, 0, 0}, m.double_sided = 1;
  const std::uint32_t floor = add_material(&s, m);
  m.diffuse = {.02f, .02f, .02f};
  const std::uint32_t dark = add_material(&s, m);
  constexpr float kEdge = 2, kHole = .3f, kHeight = 2;
  add_quad(&s, {-kEdge, 0, kEdge}, {kEdge, 0, kEdge}, {kEdge, 0, -kEdge}, {-kEdge, 0, -kEdge}, floor);
  auto ceiling = [&](float x0, float x1, float z0, float z1) {
    add_quad(&s, {x0, kHeight, z0}, {x1, kHeight, z0}, {x1, kHeight, z1}, {x0, kHeight, z1}, dark);
  };
  ceiling(-kEdge, -kHole, -kEdge, kEdge), ceiling(kHole, kEdge, -kEdge, kEdge);
  ceiling(-kHole, kHole, -kEdge, -kHole), ceiling(-kHole, kHole, kHole, kEdge);
  for (float side : {-kEdge, kEdge}) {
    add_quad(&s, {side, 0, -kEdge}, {side, kHeight, -kEdge}, {side, kHeight, kEdge}, {side, 0, kEdge}, dark);
    add_quad(&s, {-kEdge, 0, side}, {kEdge, 0, side}, {kEdge, kHeight, side}, {-kEdge, kHeight, side}, dark);
  }
  aim(&s, {0, 1, .01f}, {0, 0, 0}, 20);
  s.bind();
  auto radiance = [](const Vec3d& way) { return way.y > 0 ? .1 + 10 * way.y * way.y : .1; };
  const TestEnvironment sky(16, 16, {1, 1, 1}, [&](const Vec3d& way, int) { return Vec3d{1, 1, 1} * radiance(way); });
  sky.give(&s.scene);
  s.scene.info.background = {2, 2, 2};
  double below = 0;
  const int side = 40;
  for (int i = 0; i < side * side; ++i) {
    const double x = (i % side + .5) * 2 * kHole / side - kHole, z = (i / side + .5) * 2 * kHole / side - kHole;
    const double square = x * x + z * z + kHeight * kHeight, area = 4 * kHole * kHole / side / side;
    const Vec3d way = normalize(Vec3d{x, kHeight, z});
    below += radiance(way) * kHeight * kHeight / (kPi * square * square) * area;
  }
  const double worst = worst_error(baked_picture(s.scene, 300), .5 * below);
  MESSAGE("largest error: ", worst);
  CHECK(worst < .25);
}
