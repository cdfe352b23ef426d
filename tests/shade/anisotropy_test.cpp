// Glossy materials with a grain.
#include <doctest/doctest.h>

#include "base/rng.h"
#include "brdf/brdf_list.h"
#include "indirect/environment.h"
#include "shade_helpers.h"
#include "support/effort.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

const Vec3 kPoint = {0.1f, 0.2f, 0};

Material brushed(std::uint32_t brdf) {
  Material m;
  m.diffuse = {0.1f, 0.1f, 0.1f};
  m.brdf = brdf, m.roughness = 0.2f, m.specular = {0.7f, 0.6f, 0.5f}, m.grazing = 1;
  return m;
}

// A sheet in the plane z = 0 with ∂P/∂u along x and ∂P/∂v along y, or against it if mirrored, under a sun.
void make_sheet(GeneratedScene* s, const Material& m, const Grain& grain, bool mirrored = false) {
  add_sheet(s, 0, add_material(s, m));
  if (mirrored)
    for (Vec2& uv : s->uvs) uv.y = 1 - uv.y;
  s->with_uvs = true;
  s->grains = {grain};
  s->lights.resize(1);
  s->lights[0].kind = LightKind::directional;
  s->lights[0].direction = normalize(Vec3{-1, -2, -3});
}

// What the sheet shows, less what the lobe in double precision makes of the grain in the scene.
void check_lobe(GeneratedScene* s, const Vec3& eye, const Vec3d& grain) {
  const Material& m = s->materials[0];
  const Vec3d v = normalize(to_double(eye - kPoint)), l = -normalize(to_double(s->lights[0].direction));
  const BrdfInfo& lobe = *kBrdfList[m.brdf]->with_grain;
  const Vec3d normal = {0, 0, eye.z > 0 ? 1.0 : -1.0};
  const Vec3d f = lobe.exact_value(m, to_double(m.specular), to_double(m.diffuse) * (1 / kPiD), {normal, grain}, v, l);
  auto t = ray_renderer(s);
  REQUIRE(has(t->renderer.effects.mask, Effect::anisotropy));
  const Vec3 found = look(*t, eye, kPoint);
  for (int c = 0; c < 3; ++c)
    CHECK(static_cast<double>(found[c]) == doctest::Approx(f[c] * std::fmax(dot(normal, l), 0)).epsilon(1e-4));
}

}  // namespace

// Goal: the grain lies in the frame of the texture coordinates: along u, and against v, as glTF has it. Method: the
// renderer against the lobe in double precision with the grain by hand; both lobes, directions all around, seen from
// both sides, texture coordinates mirrored.
TEST_CASE("anisotropy_follows_the_texture_coordinates") {
  for (std::uint32_t brdf : {std::uint32_t(kGgx), std::uint32_t(kWard)})
    for (int i = 0; i < 8; ++i)
      for (bool mirrored : {false, true}) {
        GeneratedScene s;
        const double turn = 0.8 * i, strength = 0.3 + 0.1 * i;
        const Vec2 d = {static_cast<float>(strength * std::cos(turn)), static_cast<float>(strength * std::sin(turn))};
        make_sheet(&s, brushed(brdf), {d, {}}, mirrored);
        CAPTURE(brdf);
        CAPTURE(i);
        CAPTURE(mirrored);
        const double down = mirrored ? 1 : -1;
        check_lobe(&s, {1, 0.5f, 2}, {static_cast<double>(d.x), down * static_cast<double>(d.y), 0});
        if (i != 2) continue;
        s.lights[0].direction = normalize(Vec3{-1, -2, 3});
        check_lobe(&s, {1, 0.5f, -2}, {static_cast<double>(d.x), down * static_cast<double>(d.y), 0});
      }
}

// Goal: a texture turns the grain by its red and green, and weakens it by its blue. Method: closed form: a quarter
// turn at half the strength; (1, 1) is an eighth of a turn.
TEST_CASE("anisotropy_takes_its_texture") {
  for (int quarter = 0; quarter < 2; ++quarter) {
    GeneratedScene s;
    make_sheet(&s, brushed(kGgx), {{0.8f, 0}, {}});
    s.grains[0].texture.texture = add_texture(
        &s, 1, 1, {quarter ? std::array<int, 4>{{127, 255, 128, 0}} : std::array<int, 4>{{255, 255, 255, 0}}});
    const double x = quarter ? 127 / 127.5 - 1 : 1, size = std::sqrt(x * x + 1);
    const double strength = 0.8 * (quarter ? 128 / 255.0 : 1) / size;
    check_lobe(&s, {1, 0.5f, 2}, {strength * x, -strength, 0});
  }
}

// Goal: tangents at the vertices take the place of the triangle's own, interpolated; a triangle without one at each
// vertex keeps its own. Method: the lobe with the grain by hand.
TEST_CASE("anisotropy_follows_tangents_at_vertices") {
  for (bool whole : {true, false}) {
    GeneratedScene s;
    make_sheet(&s, brushed(kGgx), {{0.8f, 0}, {}});
    s.tangents.assign(s.positions.size(), {0, 127, 0, 0});
    const std::uint32_t corner = s.triangles[0].vertex(0);
    s.tangents[corner] = whole ? PackedTangent{127, 0, 0, 0} : PackedTangent();
    CAPTURE(whole);
    GeneratedScene own;
    make_sheet(&own, brushed(kGgx), {{0.8f, 0}, {}});
    auto smooth = ray_renderer(&s), flat = ray_renderer(&own);
    const Vec3 eye = {1, 0.5f, 2};
    const bool same = look(*smooth, eye, kPoint) == look(*flat, eye, kPoint);
    CHECK(same == !whole);
  }
  GeneratedScene s;
  make_sheet(&s, brushed(kGgx), {{0.8f, 0}, {}});
  s.tangents.assign(s.positions.size(), {76, 102, 0, 0});
  check_lobe(&s, {1, 0.5f, 2}, Vec3d{0.8 * 76, 0.8 * 102, 0} * (1 / std::sqrt(76.0 * 76 + 102 * 102)));
}

// Goal: vertices with a handedness need no texture coordinates. Method: the lobe with the grain by hand, of either
// handedness.
TEST_CASE("anisotropy_follows_the_frame_of_vertices") {
  for (std::int8_t handedness : {std::int8_t(1), std::int8_t(-1)})
    for (bool with_uvs : {true, false}) {
      GeneratedScene s;
      make_sheet(&s, brushed(kGgx), {{0.5f, 0.4f}, {}});
      s.with_uvs = with_uvs;
      s.tangents.assign(s.positions.size(), {0, 127, 0, handedness});
      CAPTURE(handedness);
      CAPTURE(with_uvs);
      check_lobe(&s, {1, 0.5f, 2}, {-0.4 * handedness, 0.5, 0});
    }
}

// Goal: without texture coordinates, with a grain of strength 0, with a lobe that has none, or with the effect off,
// the surface shines evenly. Method: bits of the plain lobe's picture.
TEST_CASE("anisotropy_is_absent_without_a_frame") {
  auto seen = [](const Grain& grain, std::uint32_t brdf, bool with_uvs, EffectMask off) {
    GeneratedScene s;
    make_sheet(&s, brushed(brdf), grain);
    s.with_uvs = with_uvs;
    s.bind();
    aim(&s, {1, 0.5f, 2}, kPoint, 20);
    Settings settings;
    settings.width = settings.height = 8, settings.forced_off = off;
    return render_picture(s.scene, settings, 0);
  };
  const Grain along = {{1, 0}, {}};
  const Picture even = seen({}, kGgx, true, 0);
  CHECK_FALSE(same_picture(seen(along, kGgx, true, 0), even));
  CHECK(same_picture(seen(along, kGgx, false, 0), even));
  CHECK(same_picture(seen(along, kGgx, true, bit(Effect::anisotropy)), even));
  CHECK(same_picture(seen(along, kPhong, true, 0), seen({}, kPhong, true, 0)));
}

// Goal: rays that meet brushed metal under an environment see it along the grain. Method: a metal without diffuse
// light; the look-up of the test below, with the grain by hand.
TEST_CASE("anisotropy_is_seen_under_an_environment") {
  const TestEnvironment sky(16, 8, {0.5f, 0.5f, 0.5f}, [](const Vec3d& d, int) {
    return Vec3d{1 + d.x, 1 + d.y, 1 + d.z};
  });
  Material m = brushed(kGgx);
  m.diffuse = {0, 0, 0};
  GeneratedScene s;
  make_sheet(&s, m, {{0.9f, 0}, {}});
  s.lights[0].intensity = {0, 0, 0};
  sky.give(&s.scene);
  auto t = ray_renderer(&s);
  const Vec3 eye = {1, 0.5f, 2}, way = normalize(kPoint - eye), mean = {0.5f, 0.5f, 0.5f};
  const Vec3 found = look(*t, eye, kPoint);
  const Vec3 expected = reflected_along_grain(s.scene, m, m.specular, {{0, 0, 1}, {0.9f, 0, 0}}, way, mean);
  const Vec3 even = reflected_environment(s.scene, m, m.specular, {0, 0, 1}, way, mean);
  for (int c = 0; c < 3; ++c) CHECK(found[c] == doctest::Approx(expected[c]).epsilon(1e-4));
  CHECK(length(found - even) > 0.02f);
}

// Goal: under an environment, brushed metal reflects the mean along its grain. Method: the mean of the lobe's samples,
// value × cosine × radiance / density, over views and grains, under a sky that is bright to one side; the error of the
// look-ups against that of a look-up without the grain.
TEST_CASE("anisotropy_reflects_the_environment_along_the_grain") {
  auto radiance = [](const Vec3d& d) { return 1.5 + 2 * d.x + d.x * d.y + 2 * d.z * d.z; };
  const TestEnvironment sky(64, 32, {1.5f, 1.5f, 1.5f}, [&](const Vec3d& d, int) {
    return Vec3d{1, 1, 1} * std::fmax(radiance(d), 0);
  });
  Scene scene;
  sky.give(&scene);
  const BrdfInfo& lobe = *kBrdfList[kGgx]->with_grain;
  Material m = brushed(kGgx);
  m.roughness = 0.15f, m.specular = {1, 1, 1};
  Rng rng = make_rng(4);
  double along = 0, even = 0;
  constexpr int kViews = 60, kStrata = kEffortDivisor > 1 ? 25 : 55, kSamples = kStrata * kStrata;
  for (int i = 0; i < kViews; ++i) {
    const double turn = 2 * kPiD * next_double(&rng), cosine = 0.3 + 0.6 * next_double(&rng);
    const Vec3d v = {std::sqrt(1 - cosine * cosine), 0, cosine};
    const LobeFrameD frame = {{0, 0, 1}, {0.9 * std::cos(turn), 0.9 * std::sin(turn), 0}};
    double sum = 0;
    for (int k = 0; k < kSamples; ++k) {
      const double u = (k % kStrata + next_double(&rng)) / kStrata;
      const Vec3d l = lobe.sample(m, frame, v, u, (k / kStrata + next_double(&rng)) / kStrata);
      if (!(l.z > 0)) continue;
      sum += std::fmax(radiance(l), 0) * lobe.exact_value(m, {1, 1, 1}, {0, 0, 0}, frame, v, l).x * l.z /
             lobe.density(m, frame, v, l) / kSamples;
    }
    const Vec3 one = {1, 1, 1}, mean = one * 1.5f, way = -to_float(v);
    const LobeFrame seen = {{0, 0, 1}, to_float(frame.grain)};
    along += std::fabs(static_cast<double>(reflected_along_grain(scene, m, one, seen, way, mean).x) / sum - 1);
    even += std::fabs(static_cast<double>(reflected_environment(scene, m, one, seen.normal, way, mean).x) / sum - 1);
  }
  MESSAGE("mean error: ", along / kViews, " along the grain, ", even / kViews, " without it");
  CHECK(along < even / 2);
  CHECK(along / kViews < 0.12);
}
