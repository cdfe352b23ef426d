// The dimmed studio around models that have lights but no surroundings.
#include "session/studio_fill.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/color.h"
#include "base/fmath.h"
#include "engine/renderer.h"
#include "scene/environment.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

Light lamp(const Vec3& position, float intensity) {
  Light light;
  light.position = position, light.intensity = {intensity, intensity, intensity};
  return light;
}

// A small square of albedo 0.5 that faces up, at the origin, under a light of 8 at a height of 2.
std::unique_ptr<GeneratedScene> lit_square() {
  auto s = std::make_unique<GeneratedScene>();
  Material grey;
  grey.diffuse = {0.5f, 0.5f, 0.5f}, grey.double_sided = 0;
  add_quad(s.get(), {-0.01f, 0, 0.01f}, {0.01f, 0, 0.01f}, {0.01f, 0, -0.01f}, {-0.01f, 0, -0.01f},
           add_material(s.get(), grey));
  s->lights = {lamp({0, 2, 0}, 8)};
  s->bind();
  return s;
}

}  // namespace

// Goal: a lit model in the open gets the fill; a room, a model without lights or with lights that are off, and one with
// surroundings do not. Method: one difference at a time.
TEST_CASE("studio_fill_comes_to_lit_models_in_the_open") {
  auto s = lit_square();
  CHECK(calls_for_fill(s->scene));
  s->scene.info.ambient = {0.1f, 0.1f, 0.1f};
  CHECK_FALSE(calls_for_fill(s->scene));
  s->scene.info.ambient = {0, 0, 0};
  s->lights[0].intensity = {0, 0, 0};
  CHECK_FALSE(calls_for_fill(s->scene));
  s->lights.clear(), s->bind();
  CHECK_FALSE(calls_for_fill(s->scene));
  auto room = lit_square();
  add_box(room.get(), {-3, -1, -3}, {3, 3, 3}, 0, true);
  room->bind();
  CHECK_FALSE(calls_for_fill(room->scene));
}

// Goal: the light of surfaces is that of their lights, in closed form, and none in shadow or outside a cone. Method: a
// small square under a point light, a spot, a sun, and behind a screen; the geometric mean of two squares.
TEST_CASE("studio_fill_measures_the_light_of_surfaces") {
  auto s = lit_square();
  const double expected = 8.0 / 4 * 0.5 / kPi;
  CHECK(typical_radiance(s->scene) == doctest::Approx(expected).epsilon(1e-3));
  s->lights[0].kind = LightKind::spot, s->lights[0].direction = {0, -1, 0}, s->lights[0].cos_outer = 0.9f;
  CHECK(typical_radiance(s->scene) == doctest::Approx(expected).epsilon(1e-3));
  s->lights[0].direction = {0, 1, 0};
  CHECK(typical_radiance(s->scene) == 0);
  s->lights[0].kind = LightKind::directional, s->lights[0].direction = {0, -1, 0};
  CHECK(typical_radiance(s->scene) == doctest::Approx(8 * 0.5 / kPi).epsilon(1e-3));
  s->lights = {lamp({0, -2, 0}, 8)}, s->bind();
  CHECK(typical_radiance(s->scene) == 0);  // behind it
  s->lights = {lamp({0, 2, 0}, 8)};
  add_quad(s.get(), {99.99f, 0, 0.01f}, {100.01f, 0, 0.01f}, {100.01f, 0, -0.01f}, {99.99f, 0, -0.01f}, 0);
  s->lights.push_back(lamp({100, 4, 0}, 8)), s->lights[1].range = 50, s->bind();
  CHECK(typical_radiance(s->scene) == doctest::Approx(expected / 2).epsilon(1e-2));
  Material black;
  black.diffuse = {0, 0, 0}, black.double_sided = 1;
  add_quad(s.get(), {-0.001f, 1.9f, 0.001f}, {0.001f, 1.9f, 0.001f}, {0.001f, 1.9f, -0.001f}, {-0.001f, 1.9f, -0.001f},
           add_material(s.get(), black));
  s->bind();
  CHECK(typical_radiance(s->scene) == doctest::Approx(expected / 4).epsilon(1e-2));  // the other square alone
}

// Goal: the studio's mean is two stops below the surfaces, to within half a stop, whatever the lights' unit, and all
// that describes it is dimmed alike. Method: powers of two and values between.
TEST_CASE("studio_fill_is_dimmed_to_a_quarter") {
  for (double radiance : {1e-6, 0.3, 1.0, 7.0, 40.0, 1e6}) {
    CAPTURE(radiance);
    EnvironmentInfo studio;
    studio.scale = 0.25f, studio.radiance_max = {2, 2, 2};
    for (Vec3& coefficient : studio.irradiance) coefficient = {0.4f, 0.4f, 0.4f};
    Vec3 background = {0.4f, 0.4f, 0.4f};
    dim_to_fill(radiance, &studio, &background);
    const double mean = static_cast<double>(luminance(studio.irradiance[0]));
    CHECK(mean >= kFillShare * radiance / 1.4143);
    CHECK(mean <= kFillShare * radiance * 1.4143);
    const float factor = studio.scale / 0.25f;
    CHECK(studio.irradiance[8].z == 0.4f * factor);
    CHECK(studio.radiance_max.y == 2 * factor);
    CHECK(background.x == 0.4f * factor);
    int exponent;
    CHECK(std::frexp(studio.scale, &exponent) == 0.5f);
  }
  EnvironmentInfo studio;
  studio.irradiance[0] = {1, 1, 1};
  Vec3 background = {1, 1, 1};
  dim_to_fill(0, &studio, &background);  // nothing is lit: the studio is the light
  CHECK(studio.scale == 1);
}

// Goal: exposure that is measured of surfaces alone does not depend on the background. Method: a square in front of a
// bright, a dim and a black one; measured of everything, it does.
TEST_CASE("exposure_of_surfaces_ignores_the_background") {
  auto exposure = [](float measured, float background) {
    auto s = lit_square();
    aim(s.get(), {0, 0.05f, 0.02f}, {0, 0, 0}, 40);
    s->scene.info.auto_exposure = measured, s->scene.info.background = {background, background, background};
    return make_renderer(s->scene, settings_for(0, 64, 48))->renderer.view.exposure;
  };
  const float alone = exposure(2, 0);
  CHECK(alone == doctest::Approx(0.18 / (8.0 / 4 * 0.5 / kPi)).epsilon(0.02));
  CHECK(exposure(2, 0.01f) == alone);
  CHECK(exposure(2, 50) == alone);
  CHECK(exposure(1, 50) < 0.8f * alone);
}
