// Light of the surroundings on glossy lobes.
#include <doctest/doctest.h>

#include "brdf/brdf_list.h"
#include "indirect/surroundings.h"
#include "plan/radiance_bounds.h"
#include "shade_helpers.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

Vec3 seen(const Material& m, const Vec3& ambient, const Vec3& background, const Vec3& eye,
          IndirectChoice indirect = IndirectChoice::automatic) {
  GeneratedScene s;
  add_sheet(&s, 0, add_material(&s, m));
  s.scene.info.ambient = ambient, s.scene.info.background = background;
  aim(&s, {0.1f, 0.2f, 50}, {0, 0, 0}, 40);
  s.lights.resize(1);
  s.lights[0].intensity = {0, 0, 0};
  s.bind();
  Settings settings;
  settings.width = settings.height = 1, settings.cut_off_levels = 0, settings.indirect = indirect;
  auto t = make_renderer(s.scene, settings);
  return look(*t, eye, {0, 0, 0});
}

Material metal(float alpha) {
  Material m;
  m.diffuse = {0, 0, 0}, m.specular = {1, 1, 1};
  m.brdf = kGgx, m.roughness = alpha, m.grazing = 1;
  return m;
}

}  // namespace

// Goal: a rough metal without lights shows its surroundings: ambient light, or the background where it is brighter.
// Method: a white metal reflects all of it, once or more often scattered; the bound covers it; Phong's lobe and
// --indirect none reflect lights only.
TEST_CASE("surroundings_light_metals") {
  const Vec3 ambient = {0.2f, 0.4f, 0.1f}, background = {0.1f, 0.1f, 0.3f}, most = {0.2f, 0.4f, 0.3f};
  for (float x : {1.0f, 0.7f, 0.3f}) {
    const Vec3 eye = {std::sqrt(1 - x * x), 0, x};
    const Material m = metal(1);
    Vec3 found = seen(m, ambient, background, eye);
    CAPTURE(x);
    for (int c = 0; c < 3; ++c) CHECK(double(found[c]) == doctest::Approx(double(most[c])).epsilon(0.03));
    Scene lit;
    lit.info.ambient = ambient, lit.info.background = background;
    CHECK(max_component(found) <= reflected_surroundings_bound(surroundings_max(lit, 0), m));
    CHECK(seen(m, {0, 0, 0}, {1, 1, 1}, eye).y == doctest::Approx(1).epsilon(0.03));
    CHECK(is_zero(seen(m, ambient, background, eye, IndirectChoice::none)));
    Material phong = m;
    phong.brdf = kPhong;
    CHECK(is_zero(seen(phong, ambient, background, eye)));
  }
}

// Goal: the lobe keeps its colour: reflectance at normal incidence is multiplied by the tint. Method: a smooth lobe
// seen straight on reflects F₀ of uniform light.
TEST_CASE("surroundings_are_tinted_by_metals") {
  Material m = metal(0.01f);
  m.specular = {0.9f, 0.5f, 0.2f};
  Vec3 found = seen(m, {1, 1, 1}, {0, 0, 0}, {0, 0, 1});
  for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(m.specular[c]).epsilon(0.01));
}

// Goal: in a room that stores radiosity, a rough metal reflects what is stored at the point, instead of the ambient
// term, even where there is none; the bound covers it. Method: a white metal under the same light from everywhere.
TEST_CASE("stored_light_lights_metals") {
  const Vec3 stored = {0.3f, 0.1f, 0.2f};
  for (const Vec3& ambient : {Vec3{0, 0, 0}, Vec3{5, 5, 5}}) {
    GeneratedScene s;
    const Material m = metal(1);
    add_sheet(&s, 0, add_material(&s, m));
    s.scene.info.ambient = ambient, s.scene.info.background = {0, 0, 0};
    aim(&s, {0.1f, 0.2f, 50}, {0, 0, 0}, 40);
    s.lights.resize(1);
    s.lights[0].intensity = {0, 0, 0};
    s.bind();
    std::vector<std::uint32_t> places(2 * s.scene.triangles.count, kRadiosityAtVertices);
    std::vector<Vec3> values(s.scene.positions.count, stored);
    RadiosityInfo info = {stored};
    s.scene.radiosity_triangles = {places.data(), static_cast<std::uint32_t>(places.size())};
    s.scene.radiosity_values = {values.data(), static_cast<std::uint32_t>(values.size())};
    s.scene.radiosity_info = {&info, 1};
    Settings settings;
    settings.width = settings.height = 1, settings.cut_off_levels = 0;
    auto t = make_renderer(s.scene, settings);
    CHECK(has(t->renderer.effects.mask, Effect::ambient_gloss));
    const Vec3 found = look(*t, {0, 0, 1}, {0, 0, 0});
    for (int c = 0; c < 3; ++c) CHECK(double(found[c]) == doctest::Approx(double(stored[c])).epsilon(0.03));
    CHECK(max_component(found) <= reflected_surroundings_bound(surroundings_max(s.scene, t->renderer.effects.mask), m));
  }
}

// Goal: in a room that stores radiosity, a rough metal and a coat reflect an environment as dimly or brightly as the
// stored light says, and the bound covers it. Method: an even environment and any stored light look like an even
// environment of that light in the open.
TEST_CASE("stored_light_scales_environments") {
  const Vec3 stored = {0.2f, 1, 3}, sky = {1, 1, 1};
  auto look_under = [&](const TestEnvironment& environment, const Vec3* inside, bool coated, float* bound) {
    GeneratedScene s;
    Material m = metal(0.5f);
    if (coated) m.specular = {0, 0, 0};
    add_sheet(&s, 0, add_material(&s, m));
    if (coated) {
      s.clear_coats.resize(1);
      s.clear_coats[0].strength = 1, s.clear_coats[0].roughness = s.clear_coats[0].roughness_low = 0.5f;
    }
    aim(&s, {0.1f, 0.2f, 50}, {0, 0, 0}, 40);
    s.lights.resize(1);
    s.lights[0].intensity = {0, 0, 0};
    s.bind();
    environment.give(&s.scene);
    std::vector<std::uint32_t> places(2 * s.scene.triangles.count, kRadiosityAtVertices);
    std::vector<Vec3> values(s.scene.positions.count, inside ? *inside : Vec3{0, 0, 0});
    RadiosityInfo info = {values[0]};
    if (inside) {
      s.scene.radiosity_triangles = {places.data(), static_cast<std::uint32_t>(places.size())};
      s.scene.radiosity_values = {values.data(), static_cast<std::uint32_t>(values.size())};
      s.scene.radiosity_info = {&info, 1};
    }
    Settings settings;
    settings.width = settings.height = 1, settings.cut_off_levels = 0, settings.environment_shadows = 0;
    auto t = make_renderer(s.scene, settings);
    *bound = radiance_bounds(t->renderer.frame).after[0];
    return look(*t, {0, 0.6f, 0.8f}, {0, 0, 0});
  };
  // Bright wherever a lobe looks.
  const TestEnvironment glaring(8, 4, sky, [](const Vec3d&, int) { return Vec3d{10, 10, 10}; });
  for (bool coated : {false, true}) {
    CAPTURE(coated);
    float bound;
    const Vec3 expected = look_under(even_environment(stored), nullptr, coated, &bound),
               found = look_under(even_environment(sky), &stored, coated, &bound);
    CHECK(expected.y > 0.01f);
    for (int c = 0; c < 3; ++c) CHECK(double(found[c]) == doctest::Approx(double(expected[c])).epsilon(0.01));
    CHECK(max_component(found) <= bound);
    const Vec3 half = {0.5f, 0.5f, 0.5f};
    CHECK(look_under(glaring, &half, coated, &bound).x < 0.35f * look_under(glaring, &sky, coated, &bound).x);
  }
}
