// The reference's clear coats.
#include <doctest/doctest.h>

#include "base/fmath.h"
#include "brdf/clear_coat.h"
#include "desktop/reference/rendered.h"
#include "desktop/reference/surface.h"
#include "reference/reference_helpers.h"
#include "shade/camera.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// A coated surface in the plane z = 0, as reference_surface() makes it for that viewer.
ReferenceSurface coated(const Material& base, double strength, float roughness, const Vec3d& to_viewer,
                        const Vec3d& coat_normal = {0, 0, 1}) {
  ReferenceSurface s = {};
  s.material = &base;
  s.normal = s.geometric = {0, 0, 1};
  s.passes = 1 - strength * coat_fresnel(dot(coat_normal, to_viewer));
  s.diffuse = to_double(base.diffuse) * s.passes, s.specular = to_double(base.specular);
  s.coat = coat_lobe(roughness), s.coat_lobe = strength, s.coat_normal = coat_normal;
  return s;
}

// Calls visit(direction, solid angle) over the hemisphere.
template <class Visit>
void integrate(Visit visit) {
  constexpr int kRings = 400, kSectors = 400;
  for (int i = 0; i < kRings; ++i)
    for (int k = 0; k < kSectors; ++k)
      visit(at((i + 0.5) / kRings, 2 * kPi * (k + 0.5) / kSectors), 2 * kPi / kRings / kSectors);
}

}  // namespace

// Goal: [white furnace] a coat over a white matte surface returns at most the light that it receives; as smooth as can
// be, all of it. Method: uniform light: paths, with a smooth coat exactly 1; the integral of the value with rough ones,
// which paths meet within noise. What the mirror takes of a coat is added by hand.
TEST_CASE("reference_coat_keeps_energy_in_a_furnace") {
  for (float strength : {1.0f, 0.5f})
    for (float roughness : {0.0f, 0.35f, 0.5f, 1.0f})
      for (double cosine : {0.15, 0.5, 0.95}) {
        GeneratedScene scene;
        Material white;
        white.diffuse = {1, 1, 1};
        scene.materials = {white};
        add_quad(&scene, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, 0);
        scene.clear_coats.resize(1);
        scene.clear_coats[0].strength = strength;
        scene.clear_coats[0].roughness = scene.clear_coats[0].roughness_low = roughness;
        scene.scene.info.background = {1, 1, 1};
        scene.lights.resize(1);
        scene.lights[0].intensity = {0, 0, 0};
        aim(&scene, {0, 0, 5}, {0, 0.1f, 0}, 40);
        scene.bind();
        const TestReference t(scene.scene);
        const Vec3d v = at(cosine, 0.7);
        const ReferenceSurface s = coated(scene.materials[0], static_cast<double>(strength), roughness, v);
        double reflected = 0;
        integrate([&](const Vec3d& l, double angle) { reflected += lobe_value(s, v, l).y * l.z * angle; });
        const double k = coat_mirror_share(static_cast<double>(roughness));
        reflected += static_cast<double>(strength) * k * coat_fresnel(cosine);
        CAPTURE(strength);
        CAPTURE(roughness);
        CAPTURE(cosine);
        CHECK(reflected < 1.002);
        if (roughness == 0) reflected = 1;
        check_equal(estimate(t, Transport::physical, v * 3.0, -v, effort(20000)), reflected, 2e-3);
      }
}

// Goal: a smooth coat mirrors by its own normal, not by the bumps of its base, and by Fresnel. Method: half a ceiling
// of known radiance over a black surface whose bumps would mirror the dark; both kinds of paths, and the renderer's
// rays.
TEST_CASE("reference_coat_mirrors_by_its_own_normal") {
  GeneratedScene scene;
  Material black, ceiling;
  black.diffuse = {0, 0, 0}, ceiling.diffuse = {1, 1, 1}, ceiling.unlit = 1;
  scene.materials = {black, ceiling};
  add_quad(&scene, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, 0);
  add_quad(&scene, {-400, 400, 40}, {0, 400, 40}, {0, -400, 40}, {-400, -400, 40}, 1);
  scene.with_uvs = true;
  scene.material_maps.resize(2);
  scene.material_maps[0].normal.texture = add_texture(&scene, 1, 1, {{{200, 128, 200, 255}}});
  scene.clear_coats.resize(2);
  scene.clear_coats[0].strength = 1;
  scene.lights.resize(1);
  scene.lights[0].intensity = {0, 0, 0};
  aim(&scene, {0, 0, 5}, {0, 0.1f, 0}, 40);
  scene.bind();
  TestReference t(scene.scene);
  const Vec3d v = at(0.4, 0.7);
  const double expected = 0.04 + 0.96 * std::pow(1 - 0.4, 5);
  for (Transport transport : {Transport::model, Transport::physical})
    check_equal(estimate(t, transport, v * 3.0, -v, effort(5000)), expected);
  Camera camera;
  camera.eye = to_float(v * 3.0), camera.target = {0, 0, 0}, camera.up = {0, 0, 1};
  REQUIRE(make_camera_rays(camera, 1, 1, &t.renderer->renderer.frame.view.camera).ok);
  Vec3d picture;
  trace_as_rendered(t.reference, 0, 1, &picture);
  CHECK(picture.y == doctest::Approx(expected).epsilon(1e-5));
}

// Goal: the coat's lobe is reciprocal, and light that it reflects is not dimmed by it. Method: directions exchanged;
// the value over a black base is strength × the lobe, of equal and of leaning normals.
TEST_CASE("reference_coat_is_reciprocal") {
  Material black;
  black.diffuse = {0, 0, 0};
  Rng rng = make_rng(5);
  for (int i = 0; i < 500; ++i) {
    const Vec3d v = at(0.02 + 0.97 * next_double(&rng), 6 * next_double(&rng)),
                l = at(0.02 + 0.97 * next_double(&rng), 6 * next_double(&rng));
    const float roughness = 0.05f + 0.9f * next_float(&rng);
    const ReferenceSurface there = coated(black, 0.7, roughness, v), back = coated(black, 0.7, roughness, l);
    CHECK(lobe_value(there, v, l).y == doctest::Approx(lobe_value(back, l, v).y).epsilon(1e-9));
    const Vec3d n = at(0.9, 6 * next_double(&rng));
    const ReferenceSurface leaning = coated(black, 0.7, roughness, v, n);
    const Material m = coat_lobe(roughness);
    const double cosine = std::fmax(dot(n, l), 0);
    const double lobe =
        cosine > 0 ? kGgxBrdf.exact_value(m, to_double(m.specular), {0, 0, 0}, {n, {0, 0, 0}}, v, l).y : 0;
    CHECK(lobe_value(leaning, v, l).y * l.z == doctest::Approx(0.7 * lobe * cosine).epsilon(1e-9));
  }
}

// Goal: the sum over samples of value × cosine / density is the integral of the value, whatever lies below the coat:
// the density is that of the samples. Method: smooth to rough coats over matte and glossy bases; the density's integral
// is the share of samples above the surface.
TEST_CASE("reference_coat_is_sampled_by_its_density") {
  for (const Material& base : {Material(), plastic()})
    for (float roughness : {0.25f, 0.5f, 1.0f})
      for (bool leans : {false, true}) {
        const Vec3d v = at(0.6, 0.3), n = leans ? at(0.95, 2) : Vec3d{0, 0, 1};
        const ReferenceSurface s = coated(base, 0.8, roughness, v, n);
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
        CAPTURE(leans);
        CHECK(found == doctest::Approx(value).epsilon(0.01));
        CHECK(density == doctest::Approx(above).epsilon(0.01));
      }
}
