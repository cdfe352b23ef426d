// Emitters of one material that light and hide each other, without stored light: HARDCASES rows 49 and 72.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

#include "scene/builtin_helpers.h"
#include "shade/shade_helpers.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

Material grey_lamp(float emission, float albedo, bool two_sided) {
  Material m = matte(albedo);
  m.emission = {emission, emission, emission};
  m.double_sided = two_sided;
  return m;
}

double seen(GeneratedScene* s, const Vec3& from, const Vec3& to, std::uint32_t points = 4) {
  return static_cast<double>(look(*ray_renderer(s, 16, points), from, to).x);
}

// A floor that emits 4 and reflects half, seen below the middle of a lamp.
double floor_under_lamp(bool own, float height, const std::function<void(GeneratedScene*, std::uint32_t)>& add) {
  GeneratedScene s;
  const std::uint32_t floor = add_material(&s, grey_lamp(4, .5f, false)),
                      lamp = own ? floor : add_material(&s, grey_lamp(4, .5f, false));
  add_sheet(&s, 0, floor);
  add_quad(&s, {-.5f, .5f, height}, {.5f, .5f, height}, {.5f, -.5f, height}, {-.5f, -.5f, height}, lamp);
  add(&s, floor);
  return seen(&s, {0, .1f, .2f}, {0, 0, 0});
}

}  // namespace

// Goal: a floor that emits reflects the direct light of a lamp of its own material as of any other. Method: unit square
// at height 1, form factor .2394565 to the middle below (HARDCASES row 37); both materials by turns.
TEST_CASE("hard_72_direct_light_of_a_lamp_over_a_floor_of_its_own_material") {
  count_assertions("closed form within 1e-4");
  for (bool own : {true, false})
    CHECK(floor_under_lamp(own, 1, [](GeneratedScene*, std::uint32_t) {}) ==
          doctest::Approx(4 + 4 * .5 * .2394565).epsilon(1e-4));
}

// Goal: what emits hides other emitters of its material. Method: a plate of the lamp's material below it that shines
// upwards alone; the floor then shows its own emission and no more.
TEST_CASE("hard_72_an_emitter_hides_the_lamp_of_its_own_material") {
  count_assertions("no light from the hidden lamp");
  const double hidden = floor_under_lamp(true, 1, [](GeneratedScene* s, std::uint32_t lamp) {
    add_quad(s, {-5, -5, .5f}, {5, -5, .5f}, {5, 5, .5f}, {-5, 5, .5f}, lamp);
  });
  CHECK(hidden == 4);
}

// Goal: a body whose faces shine on both sides sheds the light of its outer sides alone, as the inner ones are hidden.
// Method: closed form of a sphere, π·r²/d² of its radiance, and a box against one whose faces shine outwards.
TEST_CASE("hard_72_closed_two_sided_lamps_shine_outwards") {
  count_assertions("closed form within 3 %, one-sided box within 1e-5");
  for (int points : {16, 64, 256}) {
    GeneratedScene s;
    add_sheet(&s, 0, add_material(&s, matte(.8f)));
    add_sphere(&s, {0, 0, 4}, .5f, 48, 32, add_material(&s, grey_lamp(4, 0, true)));
    const double e = seen(&s, {0, 0, .5f}, {0, 0, 0}, static_cast<std::uint32_t>(points)) / .8;
    CAPTURE(points);
    CHECK(e == doctest::Approx(4 * .25 / 16).epsilon(points < 64 ? .1 : .03));
  }
  double boxes[2];
  for (bool two_sided : {false, true}) {
    GeneratedScene s;
    add_sheet(&s, 0, add_material(&s, matte(.8f)));
    add_box(&s, {-.5f, -.5f, 1}, {.5f, .5f, 1.2f}, add_material(&s, grey_lamp(4, 0, two_sided)));
    boxes[two_sided] = seen(&s, {1, 0, .1f}, {1, 0, 0});
  }
  CHECK(boxes[0] > 0);
  CHECK(boxes[1] == doctest::Approx(boxes[0]).epsilon(1e-5));
}

// Goal: with direct light alone the furnace shows Le·(1 + ρ) = .75, as Le arrives from everywhere. Method: the built-in
// scene; the mean, and every pixel as far as the points of an area light tell how much of it is hidden.
TEST_CASE("hard_49_furnace_with_direct_light_alone") {
  count_assertions("mean within 1 %, pixels within 10 %");
  auto built = build_builtin("furnace");
  Settings settings;
  settings.width = 32, settings.height = 24, settings.points_per_area_light = 64;
  double sum = 0, worst = 0;
  for (const Vec3& p : render_picture(built->scene, settings)) {
    const double value = static_cast<double>(p.x);
    sum += value, worst = std::max(worst, std::fabs(value / .75 - 1));
  }
  CHECK(sum / (32 * 24) == doctest::Approx(.75).epsilon(.01));
  CHECK(worst < .1);
}

// Goal: where points stand for a bent lamp, no other piece of it gets more from one of them than if the lamp were all
// around. Method: the inside of a round lamp of many flat pieces, with one point; the brightest pixel.
TEST_CASE("own_light_of_one_point_is_bounded") {
  GeneratedScene s;
  const std::uint32_t lamp = add_material(&s, grey_lamp(1, .5f, true));
  add_sphere(&s, {0, 0, 0}, 1, 24, 16, lamp);
  aim(&s, {0, 0, 0}, {.3f, .5f, .7f}, 120);
  s.bind();
  Settings settings;
  settings.width = 64, settings.height = 48, settings.points_per_area_light = 1;
  float most = 0, least = 2;
  for (const Vec3& p : render_picture(s.scene, settings)) most = std::max(most, p.x), least = std::min(least, p.x);
  CHECK(most <= 1.5001f);
  CHECK(most > least);
}
