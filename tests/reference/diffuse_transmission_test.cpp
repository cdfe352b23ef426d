// The reference's light through leaves.
#include "desktop/reference/rendered.h"
#include "reference/reference_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// A leaf over a floor in uniform light, a sun behind it, and a wall that hides a part of both from it.
void make_leaf(float strength, GeneratedScene* s) {
  Material leaf;
  leaf.diffuse = {0.3f, 0.6f, 0.2f}, leaf.brdf = kGgx, leaf.specular = {0.04f, 0.04f, 0.04f}, leaf.grazing = 1;
  leaf.roughness = 0.25f;
  Material floor;
  floor.diffuse = {0.5f, 0.4f, 0.3f};
  s->materials = {leaf, floor};
  add_quad(s, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, 0);
  add_quad(s, {-9, -9, -2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, -2}, 1);
  s->diffuse_transmissions.resize(2);
  s->diffuse_transmissions[0].strength = strength, s->diffuse_transmissions[0].color = {0.6f, 0.8f, 0.1f};
  s->lights.resize(1);
  s->lights[0].kind = LightKind::directional, s->lights[0].direction = normalize(Vec3{0.4f, 0.2f, 1});
  s->lights[0].intensity = {3, 3, 3};
  aim(s, {0, 0, 5}, {0, 0.1f, 0}, 40);
}

}  // namespace

// Goal: the reference as rendered shows light through leaves as the renderer does, and paths of the model have it as
// their mean. Method: one ray, in ambient light and under a sun that the floor hides or not.
TEST_CASE("reference_passes_light_through_leaves_as_the_renderer_does") {
  for (float strength : {0.25f, 1.0f})
    for (bool hidden : {false, true}) {
      GeneratedScene s;
      make_leaf(strength, &s);
      if (!hidden) s.triangles.resize(2);
      s.scene.info.ambient = {0.3f, 0.2f, 0.1f};
      s.bind();
      const TestReference t(s.scene);
      const Vec3d from = {0.3, 0.4, 3}, way = normalize(Vec3d{-0.1, -0.15, -1});
      const float shown = trace_ray(t.renderer->renderer, to_float(from), to_float(way)).y;
      const Estimate model = estimate(t, Transport::model, from, way, effort(20000));
      CAPTURE(strength);
      CAPTURE(hidden);
      CHECK(shown > 0.05f);
      CHECK(model.mean == doctest::Approx(static_cast<double>(shown)).epsilon(0.02));
    }
}

// Goal: paths pass leaves: of uniform light, a leaf that absorbs nothing shows all. Method: full light transport in
// uniform surroundings; white leaves one behind the other.
TEST_CASE("reference_loses_no_light_in_white_leaves") {
  for (float strength : {0.3f, 1.0f}) {
    GeneratedScene s;
    make_leaf(strength, &s);
    s.materials[0] = s.materials[1] = Material();
    s.materials[0].diffuse = s.materials[1].diffuse = {1, 1, 1};
    s.diffuse_transmissions[0].color = {1, 1, 1}, s.diffuse_transmissions[1] = s.diffuse_transmissions[0];
    s.lights[0].intensity = {0, 0, 0};
    s.scene.info.background = s.scene.info.ambient = {1, 1, 1};
    s.bind();
    const TestReference t(s.scene);
    const Estimate paths =
        estimate(t, Transport::physical, {0.3, 0.4, 3}, normalize(Vec3d{-0.1, -0.15, -1}), effort(4000));
    CAPTURE(strength);
    CHECK(paths.mean == doctest::Approx(1).epsilon(0.02));
  }
}
