#include <doctest/doctest.h>

#include <algorithm>

#include "shade/shade_helpers.h"
#include "shade/surface.h"
#include "support/effort.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr float kAlbedo = 0.8f;

// Irradiance at a point of a floor z = 0 under the scene's content.
double irradiance(const TestRenderer& t, float x, float y) {
  return double(look(t, {x, y, 0.01f}, {x, y, 0}).x) * kPiD / double(kAlbedo);
}

void add_floor(GeneratedScene* s) { add_sheet(s, 0, add_material(s, matte(kAlbedo))); }

// An area light of radiance 1 that faces down; it reflects nothing.
std::uint32_t add_lamp(GeneratedScene* s) {
  Material m = matte(0);
  m.emission = {1, 1, 1};
  m.double_sided = 0;
  return add_material(s, m);
}
void add_disk(GeneratedScene* s, float radius, float height) {
  constexpr int kSides = 16;  // 16 points each: four rings
  std::uint32_t lamp = add_lamp(s), middle = add_vertex(s, {0, 0, height}), first = middle + 1;
  for (int i = 0; i < kSides; ++i) {
    double angle = 2 * kPiD * i / kSides;
    add_vertex(s, {radius * float(std::cos(angle)), radius * float(std::sin(angle)), height});
  }
  for (std::uint32_t i = 0; i < kSides; ++i) add_triangle(s, middle, first + (i + 1) % kSides, first + i, lamp);
}
void add_square(GeneratedScene* s, float x, float height, float tilt = 0) {
  add_quad(s, {x - 0.5f, 0.5f, height - tilt}, {x + 0.5f, 0.5f, height + tilt}, {x + 0.5f, -0.5f, height + tilt},
           {x - 0.5f, -0.5f, height - tilt}, add_lamp(s));
}

}  // namespace

// Goal: point, spot and directional light. Method: closed forms I·cosθ/d², its cone and its range, E·cosθ.
TEST_CASE("light_point_spot_and_directional_closed_forms") {
  for (int kind = 0; kind < 4; ++kind) {
    GeneratedScene s;
    add_floor(&s);
    Light light;
    light.position = {0, 0, 2};
    light.intensity = {3, 2, 1};
    light.direction = {0, 0, -1};
    if (kind == 1) light.kind = LightKind::spot, light.cos_inner = 0.9f, light.cos_outer = 0.6f;
    if (kind == 2) light.kind = LightKind::directional, light.direction = normalize(Vec3{1, 2, -2});
    if (kind == 3) light.range = 4;
    s.lights.push_back(light);
    auto t = ray_renderer(&s);
    for (float x : {0.0f, 0.3f, 1.0f, 2.0f, 2.5f, 3.4f, 5.0f}) {
      double d2 = double(x) * x + 4, cosine = 2 / std::sqrt(d2), expected = 3 * cosine / d2;
      if (kind == 1) expected *= std::pow(std::min(1.0, std::max(0.0, (cosine - 0.6) / 0.3)), 2);
      if (kind == 2) expected = 3 * 2.0 / 3;
      if (kind == 3) expected *= std::max(0.0, 1 - d2 * d2 / 256);
      CAPTURE(kind);
      CAPTURE(x);
      CHECK(irradiance(*t, x, 0) == doctest::Approx(expected).epsilon(3e-5));
    }
  }
}

// Goal: a disk light of radius r at height h gives E = πL·r²/(r² + h²) below its centre, for any number of points.
// Method: closed form. 256 points err by 0.2 % from h = 2r on, 1 % at h = r, 9 % at h = r/2. One point is the centre,
// with E = πL·r²/h².
TEST_CASE("hard_36_disk_light") {
  count_assertions("closed form, 0.2 % from h = 2r on; 2 % with any number of points from h = 4r on");
  for (float h : {4.0f, 2.0f, 1.0f, 0.5f}) {
    GeneratedScene s;
    add_floor(&s);
    add_disk(&s, 1, h);
    double polygon = 16 / (2 * kPiD) * std::sin(2 * kPiD / 16);  // its area over the circle's
    double r2 = polygon;                                         // a disk of the same area as the polygon
    double expected = kPiD * r2 / (r2 + double(h) * double(h));
    CAPTURE(h);
    CHECK(irradiance(*ray_renderer(&s), 0, 0) == doctest::Approx(expected).epsilon(h > 1    ? 0.002
                                                                                   : h == 1 ? 0.01
                                                                                            : 0.09));
    if (h < 2) continue;
    for (std::uint32_t n = 1; n<256; n += kEffortDivisor> 1 ? 13 : 1) {
      CAPTURE(n);
      const double of_points = n == 1 ? kPiD * r2 / (double(h) * double(h)) : expected;
      CHECK(irradiance(*ray_renderer(&s, 16, n), 0, 0) == doctest::Approx(of_points).epsilon(h > 2 ? 0.02 : 0.06));
    }
  }
}

// Goal: a lamp that comes down to the floor lights it with E → πL, and on the way as its outline does. Method: a
// regular octagon about the axis at heights down to 1e-6 of its radius; 8 triangles seen from the axis, each with the
// closed form of a polygon, φ sin β/(2π) for the side that subtends φ, whose plane leans by β from the floor's normal.
TEST_CASE("hard_36_lamp_close_to_the_floor") {
  count_assertions("closed form within 1e-4, also of its limit");
  for (double h : {1.0, .5, .1, .01, 1e-3, 1e-4, 1e-6}) {
    CAPTURE(h);
    GeneratedScene s;
    add_sheet(&s, 0, add_material(&s, matte(kAlbedo)), false, 0.1f);
    const std::uint32_t lamp = add_lamp(&s), middle = add_vertex(&s, {0, 0, float(h)}), first = middle + 1;
    for (int i = 0; i < 8; ++i) {
      const double angle = 2 * kPiD * i / 8;
      add_vertex(&s, {float(std::cos(angle)), float(std::sin(angle)), float(h)});
    }
    for (std::uint32_t i = 0; i < 8; ++i) add_triangle(&s, middle, first + (i + 1) % 8, first + i, lamp);
    const double apothem = std::cos(kPiD / 8), side = std::sin(kPiD / 8), far = std::sqrt(apothem * apothem + h * h);
    const double expected = 8 * 2 * std::atan(side / far) * apothem / far / 2;
    const auto t = ray_renderer(&s);
    const double e = double(look(*t, {0, 0, float(h / 2)}, {0, 0, 0}).x) * kPiD / double(kAlbedo);
    CHECK(e == doctest::Approx(expected).epsilon(1e-4));
    if (h <= 1e-4) CHECK(e == doctest::Approx(kPiD).epsilon(2e-4));
  }
}

// Goal: the unit square at height 1: form factors .2394565 to the centre below and .1385316 below a corner. Method:
// closed form; 256 points reach it to one part in a thousand, n points to 0.36 / n, as midpoints of cells do.
TEST_CASE("hard_37_unit_square_light") {
  count_assertions("closed form within 0.1 %, within 0.36 / n with n points");
  GeneratedScene s;
  add_floor(&s);
  add_square(&s, 0, 1);
  for (std::uint32_t n = 1; n <= 256; n += kEffortDivisor > 1 ? 17 : 1) {
    auto t = ray_renderer(&s, 16, n);
    double error = n == 256 ? 1e-3 : 0.36 / n;
    CAPTURE(n);
    CHECK(irradiance(*t, 0, 0) == doctest::Approx(.2394565 * kPiD).epsilon(error));
    CHECK(irradiance(*t, 0.5f, 0.5f) == doctest::Approx(.1385316 * kPiD).epsilon(error));
  }
}

// Goal: a light that sinks below the horizon fades without a jump and never goes negative. Method: sweep of a tilted
// square; the steps are bounded by the share of one of its points, for several numbers of them.
TEST_CASE("hard_38_light_crosses_the_horizon") {
  count_assertions("at least 0, no jump");
  for (std::uint32_t n : {256u, 1u, 2u, 3u, 4u, 7u, 8u, 12u, 50u}) {
    double before = -1;
    for (int i = 0; i <= 100; ++i) {
      GeneratedScene s;
      add_sheet(&s, 0, add_material(&s, matte(kAlbedo)), false, 0.5f);  // small: it must not hide the light
      add_square(&s, 2, 1 - 0.02f * static_cast<float>(i), 0.5f);
      double e = irradiance(*ray_renderer(&s, 16, n), 0.01f, 0);
      CAPTURE(n);
      CHECK((e >= 0 && std::isfinite(e)));
      if (i > 0) CHECK(std::fabs(e - before) < 0.02 + 0.1 / n);
      before = e;
    }
    CHECK(before == 0);
  }
}

// Goal: an ever smaller area light tends to a point light. Method: closed form πL·r²/h² down to r = 1e-6 of the height.
TEST_CASE("hard_40_area_light_shrinks_to_a_point") {
  count_assertions("closed form within 0.2 %");
  for (float r : {1e-2f, 1e-4f, 1e-6f}) {
    GeneratedScene s;
    add_floor(&s);
    add_disk(&s, r, 1);
    double polygon = 16 / (2 * kPiD) * std::sin(2 * kPiD / 16);
    CHECK(irradiance(*ray_renderer(&s), 0, 0) == doctest::Approx(kPiD * double(r) * double(r) * polygon).epsilon(2e-3));
  }
}

// Goal: a point inside a closed emitter of radiance L receives πL. Method: closed form, with 256 points on a sphere, to
// 2 %.
TEST_CASE("hard_49_point_inside_an_emitter") {
  count_assertions("closed form");
  GeneratedScene s;
  Material lamp = matte(0);
  lamp.emission = {1, 1, 1};
  add_sphere(&s, {0, 0, 0}, 1, 16, 10, add_material(&s, lamp));
  add_sheet(&s, 0, add_material(&s, matte(kAlbedo)), false, 0.01f);
  CHECK(irradiance(*ray_renderer(&s), 0, 0) == doctest::Approx(kPiD).epsilon(0.02));
}

// Goal: an occluder 8 ulp in front of a light blocks it, and a light never occludes itself: all points of an area light
// arrive. Method: an occluder just in front of a point light and of an area light, near and far from the origin, from
// points all over the floor; without it the closed form.
TEST_CASE("hard_22_occluder_just_before_the_light") {
  for (float h : {1.0f, 1000.0f, 1e6f})
    for (bool area : {false, true})
      for (bool blocked : {false, true}) {
        GeneratedScene s;
        add_sheet(&s, 0, add_material(&s, matte(kAlbedo)), false, 4 * h);
        float half = 0.02f * h;  // small: the closed form is for its centre; one of its 256 points would be missed
        if (area) {
          add_quad(&s, {-half, half, h}, {half, half, h}, {half, -half, h}, {-half, -half, h}, add_lamp(&s));
        } else {
          Light light;
          light.position = {0, 0, h};
          s.lights.push_back(light);
        }
        float before = h;
        for (int i = 0; i < 8; ++i) before = std::nextafterf(before, 0);
        if (blocked) add_sheet(&s, before, add_material(&s, matte(0.1f)), false, 4 * h);
        auto t = ray_renderer(&s);
        Rng rng = make_rng(22);
        int wrong = 0, points = gate_share(200, 20000);
        for (int i = 0; i < points; ++i) {
          float x = h * (2 * next_float(&rng) - 1), y = h * (2 * next_float(&rng) - 1);
          double d2 = double(x) * x + double(y) * y + double(h) * h, intensity = area ? 4 * double(half) * half : 1;
          double cosine = h / std::sqrt(d2), expected = intensity * cosine / d2 * (area ? cosine : 1);
          double e = double(look(*t, {x, y, 0.01f * h}, {x, y, 0}).x) * kPiD / double(kAlbedo);
          wrong += !(blocked ? e == 0 : std::fabs(e - expected) <= (area ? 1e-3 : 2e-5) * expected);
        }
        CAPTURE(h);
        CAPTURE(area);
        CAPTURE(blocked);
        CHECK(wrong == 0);
        count_hard(points, wrong, "none arrives, or all does");
      }
}

// Goal: along a coarse sphere with smooth normals light fades to the terminator: never dark within the lit part, never
// lit beyond, and no facet dark where the smooth surface is lit. Method: walks along great circles from the light's
// pole to the other; irradiance follows the interpolated normal.
TEST_CASE("hard_23_terminator_of_a_coarse_smooth_sphere") {
  GeneratedScene s;
  add_sphere(&s, {0, 0, 0}, 1, 12, 8, add_material(&s, matte(kAlbedo)));
  s.with_normals = true;
  Light light;
  light.kind = LightKind::directional;
  light.direction = normalize(Vec3{-0.3f, -0.8f, -0.5f});
  s.lights.push_back(light);
  auto t = ray_renderer(&s);
  Vec3 pole = -light.direction, side, other;
  make_basis(pole, &side, &other);
  int relit = 0, dark_facets = 0, brighter = 0;
  for (int circle = 0; circle < 180; ++circle) {
    double around = circle * kPiD / 90;
    Vec3 out = side * float(std::cos(around)) + other * float(std::sin(around));
    bool dark = false;
    float before = 1;
    for (int i = 0; i <= 720; ++i) {
      double angle = kPiD * i / 720;
      Vec3 direction = pole * float(std::cos(angle)) + out * float(std::sin(angle));
      Vec3 eye = direction * 3.0f;
      Hit hit;
      t->renderer.accel.info->closest(t->renderer.accel.built, {eye, -direction, 9}, nullptr, &hit, nullptr);
      Surface surface;
      t->renderer.frame.kernels.surface(t->renderer.frame, {eye, -direction, 9}, hit, &surface);
      float facing = dot(surface.normal, pole);
      float radiance = look(*t, eye, {0, 0, 0}).x;
      bool lit = radiance > 0;
      brighter +=
          radiance > before + 2e-7f;  // normals equal directions on this sphere, so Lambert's cosine only decreases
      before = radiance;
      relit += dark && lit;
      dark |= !lit;
      dark_facets += !lit && facing > 0.02f;
    }
  }
  CHECK(relit == 0);
  CHECK(dark_facets == 0);
  CHECK(brighter == 0);
  count_hard(180 * 721, relit + dark_facets + brighter, "monotone, no lit-dark-lit");
}

// Goal: objects beyond a light cast no shadow. Method: a floor under a point light, with and without a wall above the
// light: the same radiance, bit for bit; and none with the wall between them.
TEST_CASE("light_is_not_shadowed_by_what_lies_beyond_it") {
  Vec3 seen[3];
  for (int i = 0; i < 3; ++i) {
    GeneratedScene s;
    std::uint32_t m = add_material(&s, Material());
    add_quad(&s, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, m);
    float z = i == 1 ? 1.25f : 0.75f;
    if (i > 0) add_quad(&s, {-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}, m);
    Light light;
    light.position = {0, 0, 1}, light.intensity = {1, 1, 1};
    s.lights.push_back(light);
    aim(&s, {0, 0, 9}, {0, 0, 0}, 40);
    s.bind();
    seen[i] = trace_ray(make_renderer(s.scene, settings_for(0, 4, 3))->renderer, {0.25f, 0, 0.5f}, {0, 0, -1});
  }
  CHECK(seen[0].x > 0);
  CHECK(seen[1].x == seen[0].x);
  CHECK(seen[2].x == 0);
}
