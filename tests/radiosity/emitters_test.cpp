// Stored light on surfaces that emit, in the rendered pixel: HARDCASES rows 49 and 72.
#include <doctest/doctest.h>

#include <cmath>

#include "radiosity/loose.h"
#include "scene/builtin_helpers.h"
#include "support/hard_case.h"

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

// Goal: a floor that emits reflects the light of a lamp of its own material above it, as of any other. Method: unit
// square at height 1 over the middle of the floor, form factor .2394565 (HARDCASES row 37); both materials by turns.
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
    const double light = 4 * .5 * .2394565;
    for (const Vec3& p : baked_picture(s.scene, 1200))
      CHECK(static_cast<double>(p.x) - 4 == doctest::Approx(light).epsilon(.01));
  }
}
