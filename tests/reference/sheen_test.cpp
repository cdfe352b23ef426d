// The reference's sheens.
#include <doctest/doctest.h>

#include "base/fmath.h"
#include "brdf/clear_coat.h"
#include "brdf/sheen.h"
#include "desktop/reference/surface.h"
#include "reference/reference_helpers.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// A surface with a sheen in the plane z = 0, as reference_surface() makes it for that viewer.
ReferenceSurface cloth(const Material& base, const Vec3d& color, double roughness, const Vec3d& to_viewer) {
  ReferenceSurface s = {};
  s.material = &base;
  s.normal = s.geometric = s.coat_normal = {0, 0, 1};
  s.sheen = color, s.sheen_roughness = roughness;
  s.passes = 1 - max_component(color) * sheen_albedo(roughness, to_viewer.z);
  s.diffuse = to_double(base.diffuse) * s.passes, s.specular = to_double(base.specular);
  return s;
}

// Calls visit(direction, solid angle) over the hemisphere, with more directions near the horizon.
template <class Visit>
void integrate(Visit visit) {
  constexpr int kRings = 300, kSectors = 300;
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kSectors; ++k) {
      const double t = (i + 0.5) / kRings;
      visit(at(t * t, 2 * kPi * (k + 0.5) / kSectors), 4 * kPi * t / kRings / kSectors);
    }
}

}  // namespace

// Goal: [white furnace] a white sheen over a white matte surface returns at most the light that it receives and nearly
// all of it, and paths find what the lobes' integral is. Method: uniform light, from below the least roughness to 1;
// coloured sheens; views from steep to grazing.
TEST_CASE("reference_sheen_keeps_energy_in_a_furnace") {
  for (const Vec3& color : {Vec3{1, 1, 1}, Vec3{0.2f, 0.9f, 0.4f}})
    for (float roughness : {0.05f, 0.2f, 0.5f, 1.0f})
      for (double cosine : {0.05, 0.3, 0.95}) {
        GeneratedScene scene;
        Material white;
        white.diffuse = {1, 1, 1};
        scene.materials = {white};
        add_quad(&scene, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, 0);
        scene.sheens.resize(1);
        scene.sheens[0].color = color, scene.sheens[0].roughness = scene.sheens[0].roughness_low = roughness;
        scene.scene.info.background = {1, 1, 1};
        scene.lights.resize(1);
        scene.lights[0].intensity = {0, 0, 0};
        aim(&scene, {0, 0, 5}, {0, 0.1f, 0}, 40);
        scene.bind();
        const TestReference t(scene.scene);
        const Vec3d v = at(cosine, 0.7);
        const ReferenceSurface s = cloth(scene.materials[0], to_double(color), static_cast<double>(roughness), v);
        Vec3d reflected = {0, 0, 0};
        integrate([&](const Vec3d& l, double angle) { reflected += lobe_value(s, v, l) * (l.z * angle); });
        CAPTURE(roughness);
        CAPTURE(cosine);
        CAPTURE(reflected.y);
        CHECK(max_component(reflected) < 1.0005);
        CHECK(reflected.y > (roughness < 0.1f ? 0.94 : 0.97));
        check_equal(estimate(t, Transport::physical, v * 3.0, -v, effort(20000)), reflected.y, 3e-3);
      }
}

// Goal: the renderer's even reflection of light from everywhere is what paths find. Method: a black surface under
// uniform light, with and without a coat: paths against the model, within the table's margin.
TEST_CASE("reference_sheen_reflects_uniform_light_by_its_albedo") {
  for (float strength : {0.0f, 1.0f}) {
    GeneratedScene scene;
    Material black;
    black.diffuse = {0, 0, 0};
    scene.materials = {black};
    add_quad(&scene, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, 0);
    scene.sheens.resize(1), scene.clear_coats.resize(1);
    scene.sheens[0].color = {1, 1, 1}, scene.sheens[0].roughness = scene.sheens[0].roughness_low = 0.6f;
    scene.clear_coats[0].strength = strength,
    scene.clear_coats[0].roughness = scene.clear_coats[0].roughness_low = 0.4f;
    scene.scene.info.background = scene.scene.info.ambient = {1, 1, 1};
    scene.lights.resize(1);
    scene.lights[0].intensity = {0, 0, 0};
    aim(&scene, {0, 0, 5}, {0, 0.1f, 0}, 40);
    scene.bind();
    const TestReference t(scene.scene);
    for (double cosine : {0.2, 0.6, 0.95}) {
      const Vec3d v = at(cosine, 0.7);
      const Estimate model = estimate(t, Transport::model, v * 3.0, -v, 100);
      CAPTURE(strength);
      CAPTURE(cosine);
      CHECK(estimate(t, Transport::physical, v * 3.0, -v, effort(20000)).mean ==
            doctest::Approx(model.mean).epsilon(0.05));
    }
  }
}

// Goal: the sum over samples of value × cosine / density is the integral of the value, whatever lies below: the density
// is that of the samples. Method: matte and glossy bases.
TEST_CASE("reference_sheen_is_sampled_by_its_density") {
  for (const Material& base : {Material(), plastic()})
    for (double roughness : {0.3, 0.6, 1.0}) {
      const Vec3d v = at(0.3, 0.3);
      const ReferenceSurface s = cloth(base, {0.8, 0.8, 0.8}, roughness, v);
      double value = 0, density = 0, found = 0, above = 0;
      integrate([&](const Vec3d& l, double angle) {
        value += lobe_value(s, v, l).y * l.z * angle, density += lobe_density(s, v, l) * angle;
      });
      Rng rng = make_rng(8);
      const int count = effort(100000);
      for (int i = 0; i < count; ++i) {
        Vec3d l;
        const double choice = next_double(&rng), u = next_double(&rng);
        if (!sample_lobes(s, v, choice, {u, next_double(&rng)}, &l)) continue;
        found += lobe_value(s, v, l).y * l.z / lobe_density(s, v, l) / count, above += 1.0 / count;
      }
      CAPTURE(roughness);
      CHECK(found == doctest::Approx(value).epsilon(0.02));
      CHECK(density == doctest::Approx(above).epsilon(0.02));
    }
}
