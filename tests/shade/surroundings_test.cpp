// Light of the surroundings on glossy lobes.
#include <doctest/doctest.h>

#include "brdf/brdf_list.h"
#include "indirect/surroundings.h"
#include "shade_helpers.h"

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
    SceneInfo info;
    info.ambient = ambient, info.background = background;
    CHECK(max_component(found) <= reflected_surroundings_bound(info, m));
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
