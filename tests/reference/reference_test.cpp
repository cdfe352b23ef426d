// The reference against closed forms, and the renderer against the reference.
#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "brdf/directions.h"
#include "desktop/reference/light.h"
#include "desktop/reference/rendered.h"
#include "reference/reference_helpers.h"
#include "shade/camera.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// Green radiance along a ray: the picture of one pixel seen by a camera that looks along it.
double rendered_along(TestReference* t, const Vec3d& eye, const Vec3d& direction) {
  Camera camera;
  camera.eye = to_float(eye), camera.target = to_float(eye + direction), camera.up = {0, 1, 0};
  REQUIRE(make_camera_rays(camera, 1, 1, &t->renderer->renderer.frame.view.camera).ok);
  Vec3d picture;
  trace_as_rendered(t->reference, 0, 1, &picture);
  return picture.y;
}

}  // namespace

// Goal: glass of index 1.5 at normal incidence lets 12/13 through and reflects 1/13 (HARDCASES row 34), facing mirrors
// add up to Σρᵏ (row 35), and paths that end earlier to the first terms of either. Method: a glowing wall behind a slab
// and one before it; two mirrors that glow. What branches at each boundary is exact at every depth.
TEST_CASE("reference_optics_have_their_closed_forms") {
  GeneratedScene s;
  Material glass;
  glass.diffuse = {0, 0, 0}, glass.transmission = {1, 1, 1}, glass.ior = 1.5f;
  Material mirror = emitter(1);
  mirror.mirror = {0.75f, 0.75f, 0.75f};
  std::uint32_t g = add_material(&s, glass), e = add_material(&s, emitter(2)), m = add_material(&s, mirror);
  add_box(&s, {-50, -50, -1}, {50, 50, 0}, g);
  add_quad(&s, {-90, -90, -5}, {90, -90, -5}, {90, 90, -5}, {-90, 90, -5}, e);
  add_quad(&s, {200, -9, -9}, {200, 9, -9}, {200, 9, 9}, {200, -9, 9}, m);
  add_quad(&s, {201, -9, -9}, {201, 9, -9}, {201, 9, 9}, {201, -9, 9}, m);
  add_camera(&s);
  s.bind();
  const Vec3d slab_eye = {0.3, 0.1, 3}, wall_eye = {0.3, 0.1, -3}, mirror_eye = {200.5, 0.1, 0.2};
  const Vec3d down = {0, 0, -1}, up = {0, 0, 1}, along = {1, 0, 0};
  TestReference t(s.scene);
  for (Transport transport : {Transport::model, Transport::physical}) {
    check_equal(estimate(t, transport, slab_eye, down, effort(10000)), 2 * 12.0 / 13);
    // From between wall and slab: light of the wall reflected by the slab; the wall reflects nothing.
    check_equal(estimate(t, transport, wall_eye, up, effort(10000)), 2 / 13.0);
    check_equal(estimate(t, transport, mirror_eye, along, effort(10000)), 1 / (1 - 0.75));
  }
  double passed = 0, sent_back = 0, mirrors = 0, order = 1;
  for (std::uint32_t depth = 0; depth < 12; ++depth) {
    if (depth >= 2 && depth % 2 == 0) passed += 2 * 0.96 * 0.96 * std::pow(0.04, depth - 2);
    if (depth == 1) sent_back += 2 * 0.04;
    if (depth >= 3 && depth % 2 == 1) sent_back += 2 * 0.96 * 0.96 * std::pow(0.04, depth - 2);
    mirrors += order, order *= 0.75;
    Settings settings = small_settings();
    settings.ray_depth = depth;
    TestReference limited(s.scene, settings);
    CAPTURE(depth);
    CHECK(std::fabs(rendered_along(&limited, slab_eye, down) - passed) < 1e-6);
    CHECK(std::fabs(rendered_along(&limited, wall_eye, up) - sent_back) < 1e-6);
    CHECK(std::fabs(rendered_along(&limited, mirror_eye, along) - mirrors) < 1e-6);
    if (depth <= 4)  // before chance ends paths
      check_equal(estimate(t, Transport::physical, mirror_eye, along, 1, 1, depth), mirrors);
  }
}

// Goal: boundaries reflect as in HARDCASES rows 32 and 33, to 1e-6. Method: their table.
TEST_CASE("reference_boundary_reflects_by_fresnel") {
  struct Case {
    double ior, degrees, reflectance;
  };
  for (Case c : {Case{1.33, 0, 0.0200593}, Case{1.5, 0, 0.04}, Case{2.42, 0, 0.172395}, Case{1.5, 45, 0.0502399},
                 Case{1.5, 60, 0.0891867}, Case{1.5, 80, 0.387704}, Case{1.5, 56.3099, 0.0739645}}) {
    double cos_t;
    CHECK(std::fabs(boundary_reflectance(std::cos(radians(c.degrees)), 1 / c.ior, &cos_t) - c.reflectance) < 1e-6);
    CHECK(std::fabs(std::sqrt(1 - cos_t * cos_t) * c.ior - std::sin(radians(c.degrees))) < 1e-12);
  }
  double cos_t;
  CHECK(boundary_reflectance(std::cos(std::asin(1 / 1.5) + 2e-7), 1.5, &cos_t) == 1);
  CHECK(boundary_reflectance(std::cos(std::asin(1 / 1.5) - 2e-7), 1.5, &cos_t) < 1);
}

// Goal: the lobes' directions have the stated density. Method: chi² over the cosine and the azimuth around the mirror
// direction, every lobe listed, exponents from blunt to sharp; 99.9 % bound for the cells.
TEST_CASE("reference_density_is_that_of_its_samples") {
  // Needs only the surface, no scene.
  constexpr int kRings = 12, kSectors = 8;
  constexpr float kExponents[] = {0, 1, 20, 400};
  for (std::uint32_t row = 0; row < 8 * kBrdfCount; ++row) {
    const float exponent = kExponents[row % 4];
    Material m;
    m.specular = {0.4f, 0.4f, 0.4f}, m.brdf = row / 8, m.exponent = exponent;
    const bool has_grain = row % 8 >= 4;
    if (has_grain && !kBrdfList[m.brdf]->with_grain) continue;
    m.roughness = std::sqrt(2 / (exponent + 2)), m.grazing = 1;
    ReferenceSurface s = {};
    s.material = &m;
    s.normal = s.geometric = normalize(Vec3d{0.1, 1, 0.2});
    s.diffuse = {0.3, 0.3, 0.3};
    Vec3d to_viewer = normalize(Vec3d{0.5, 1, -0.3}), tangent, bitangent;
    make_basis(s.normal, &tangent, &bitangent);
    if (has_grain) s.grain = tangent * 0.5 - bitangent * 0.3;
    auto cell = [&](const Vec3d& d) {
      int ring = std::min(kRings - 1, static_cast<int>(dot(d, s.normal) * kRings));
      double turn = std::atan2(dot(d, bitangent), dot(d, tangent)) / (2 * kPi) + 0.5;
      return ring * kSectors + std::min(kSectors - 1, static_cast<int>(turn * kSectors));
    };
    // The stated density, by the midpoint rule over each cell.
    std::vector<double> claimed(kRings * kSectors), found(kRings * kSectors);
    constexpr int kFine = 60;
    double total = 0;
    for (int i = 0; i < kRings * kFine; ++i)
      for (int j = 0; j < kSectors * kFine; ++j) {
        double cosine = (i + 0.5) / (kRings * kFine), turn = 2 * kPi * ((j + 0.5) / (kSectors * kFine) - 0.5);
        double sine = std::sqrt(1 - cosine * cosine);
        Vec3d d = tangent * (sine * std::cos(turn)) + bitangent * (sine * std::sin(turn)) + s.normal * cosine;
        double share = lobe_density(s, to_viewer, d) * 2 * kPi / (kRings * kFine * kSectors * kFine);
        claimed[static_cast<std::size_t>(cell(d))] += share;
        total += share;
      }
    Rng rng = make_rng(11);
    int count = effort(200000), above = 0;
    for (int i = 0; i < count; ++i) {
      Vec3d d;
      double choice = next_double(&rng), u = next_double(&rng);
      if (!sample_lobes(s, to_viewer, choice, {u, next_double(&rng)}, &d)) continue;
      ++above;
      found[static_cast<std::size_t>(cell(d))] += 1;
    }
    CHECK(std::fabs(total - static_cast<double>(above) / count) < 0.01);
    double chi2 = 0;
    int cells = 0;
    for (std::size_t i = 0; i < claimed.size(); ++i) {
      double expected = claimed[i] * count;
      if (expected < 10) continue;
      chi2 += (found[i] - expected) * (found[i] - expected) / expected;
      ++cells;
    }
    CAPTURE(exponent);
    CAPTURE(row);
    CHECK(cells > 4);
    CHECK(chi2 < cells + 3.1 * std::sqrt(2.0 * cells) + 10);
  }
}

// Goal: the renderer's radiance is the limit of its own model. Method: generated scenes with each single feature and
// with all, camera rays, no cut-off. Without random choices both agree to float precision; mirrors and glass, which the
// reference selects at random, within five standard errors. Rays that float rounding moves across an edge are few.
TEST_CASE("reference_model_is_the_renderers_limit") {
  // Rough glass is a lobe there and a few rays here: rough_glass_test.cpp.
  std::uint32_t without =
      bit(Feature::emission) | bit(Feature::animation) | bit(Feature::supersampling) | bit(Feature::rough_refraction);
  std::uint32_t chance = bit(Feature::mirror) | bit(Feature::refraction) | bit(Feature::thin) |
                         bit(Feature::alpha_blend) | bit(Feature::clear_coat) | bit(Feature::transmission_map);
  std::vector<std::uint32_t> sets = {kAllFeatures & ~without};
  for (int i = 0; i < kFeatureCount; ++i)
    if (!(without & 1u << i)) sets.push_back(1u << i | bit(Feature::point_light));
  sets.push_back(bit(Feature::refraction) | bit(Feature::absorption) | bit(Feature::point_light));
  sets.push_back(bit(Feature::texture) | bit(Feature::second_uv) | bit(Feature::point_light));
  sets.push_back(bit(Feature::alpha_mask) | bit(Feature::alpha_blend) | bit(Feature::texture) |
                 bit(Feature::second_uv) | bit(Feature::directional_light));
  sets.push_back(bit(Feature::metallic_roughness) | bit(Feature::normal_map) | bit(Feature::occlusion) |
                 bit(Feature::anisotropy) | bit(Feature::texture) | bit(Feature::second_uv) | bit(Feature::ambient) |
                 bit(Feature::point_light));
  const std::uint32_t coated = bit(Feature::clear_coat) | bit(Feature::point_light);
  sets.push_back(coated | bit(Feature::texture) | bit(Feature::normal_map) | bit(Feature::occlusion) |
                 bit(Feature::ambient) | bit(Feature::smooth_normal));
  sets.push_back(coated | bit(Feature::metallic_roughness) | bit(Feature::anisotropy) | bit(Feature::specular));
  sets.push_back(coated | bit(Feature::refraction) | bit(Feature::mirror) | bit(Feature::alpha_blend));
  const std::size_t plain_count = sets.size();
  sets.push_back(bit(Feature::texture) | bit(Feature::vertex_color) | bit(Feature::point_light));
  sets.push_back(sets.back() | bit(Feature::mirror) | bit(Feature::smooth_normal));
  for (std::size_t i_set = 0; i_set < sets.size(); ++i_set) {
    const std::uint32_t set = sets[i_set];
    auto s = generate_scene(set, 17);
    if (i_set >= plain_count)  // all of metal
      for (Material& m : s->materials) {
        m.brdf = kGgx, m.roughness = 0.2f, m.grazing = 1;
        m.specular = {0.8f, 0.7f, 0.5f}, m.specular_tinted = {0.7f, 0.7f, 0.3f}, m.mirror_tinted = m.mirror * 0.5f;
      }
    Settings settings = settings_for(set, 8, 8);
    settings.texture_filter = TextureFilter::bilinear;  // as the reference, which takes samples instead of levels
    settings.cut_off_levels = 0, settings.ray_depth = kRayDepthMax;
    TestReference t(s->scene, settings);
    const FrameData& frame = t.renderer->renderer.frame;
    Rng rng = make_rng(5);
    bool by_chance = (set & chance) != 0;
    int count = effort(50), unequal = 0;
    double worst = 0;
    for (int i = 0; i < count; ++i) {
      // Small objects as often as large ones: towards a random triangle.
      const Triangle& at = s->scene.triangles[next_u32(&rng) % s->scene.triangles.count];
      float u = 0.5f * next_float(&rng), v = 0.5f * next_float(&rng);
      Vec3 point = frame.geometry.positions[at.vertex(0)] * (1 - u - v) + frame.geometry.positions[at.vertex(1)] * u +
                   frame.geometry.positions[at.vertex(2)] * v;
      Vec3 direction = normalize(point - frame.view.camera.eye);
      double rendered = static_cast<double>(trace_ray(t.renderer->renderer, frame.view.camera.eye, direction).y);
      Estimate e = estimate(t, Transport::model, to_double(frame.view.camera.eye), to_double(direction),
                            by_chance ? 500 : 1, 100 + i, kRayDepthMax);
      double off = std::fabs(e.mean - rendered);
      unequal += off > 5 * e.error + 1e-4 * rendered;
      if (off > 5 * e.error + 1e-4 * rendered) worst = std::fmax(worst, off);
    }
    CAPTURE(set);
    CAPTURE(worst);
    CHECK(unequal <= count / 50);
  }
}
