#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>
#include <utility>

#include "accel/accel_list.h"
#include "base/limits.h"
#include "plan/plan_lights.h"
#include "plan/radiance_bounds.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

const std::uint32_t kCounts[] = {1, 2, 3, 4, 5, 7, 9, 16, 50, 64, 256};

std::vector<LightPoint> points_of(const GeneratedScene& s, std::uint32_t n) {
  Settings settings = settings_for(0, 4, 3);
  settings.points_per_area_light = n;
  auto test = make_renderer(s.scene, settings);
  const Array<const LightPoint>& lights = test->renderer.frame.lights.points;
  return std::vector<LightPoint>(lights.begin(), lights.end());
}

Material lamp(float radiance) {
  Material m;
  m.emission = {radiance, radiance / 2, radiance / 4};
  return m;
}

std::unique_ptr<GeneratedScene> lamp_scene() {
  auto s = std::make_unique<GeneratedScene>();
  aim(s.get(), {0, 0, 9}, {0, 0, 0}, 40);
  return s;
}

}  // namespace

// Goal: N points have the power of the surface that they represent, for any N: emission × area × π [Lambert]. Method:
// closed form, on a square, a triangle, a box and a sphere.
TEST_CASE("plan_lights_keep_the_power_of_an_area_light") {
  for (int shape = 0; shape < 4; ++shape)
    for (std::uint32_t n : kCounts) {
      auto s = lamp_scene();
      std::uint32_t m = add_material(s.get(), lamp(3));
      double area = 0;
      if (shape == 0) add_quad(s.get(), {0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}, m), area = 6;
      if (shape == 1) {
        for (Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 4, 0}}) add_vertex(s.get(), p);
        add_triangle(s.get(), 0, 1, 2, m), area = 2;
      }
      if (shape == 2) add_box(s.get(), {0, 0, 0}, {1, 2, 3}, m), area = 22;
      if (shape == 3) {
        add_sphere(s.get(), {1, 1, 1}, 0.5f, 8, 6, m);
        for (const Triangle& t : s->triangles) {
          Vec3 a = s->positions[t.vertex(0)], b = s->positions[t.vertex(1)], c = s->positions[t.vertex(2)];
          area += 0.5 * double(length(cross(b - a, c - a)));
        }
      }
      s->bind();
      std::vector<LightPoint> points = points_of(*s, n);
      CAPTURE(shape);
      CAPTURE(n);
      REQUIRE(points.size() == (shape == 2 ? 6 * n : n));  // a box is six lamps
      double power = 0;
      for (const LightPoint& p : points) {
        const std::size_t i = static_cast<std::size_t>(&p - points.data());
        power += kPi * double(p.intensity.x);
        CHECK(p.intensity == points[i / n * n].intensity);  // equal shares
        CHECK(p.intensity.y == doctest::Approx(double(p.intensity.x) / 2));
        CHECK(p.material == m);
      }
      CHECK(power == doctest::Approx(3 * area * kPi).epsilon(1e-5));
    }
}

// Goal: the points lie on the surface, spread evenly, and their mean is its centre, whatever their number, so that a
// light does not move. Method: a square and a triangle, every count; a single point is the centre; their moment of
// inertia tends to the surface's.
TEST_CASE("plan_lights_points_lie_evenly_on_the_surface") {
  for (bool triangle : {false, true}) {
    auto s = lamp_scene();
    std::uint32_t m = add_material(s.get(), lamp(1));
    if (triangle) {
      for (Vec3 p : {Vec3{-1, -1, 0.5f}, Vec3{2, -1, 0.5f}, Vec3{-1, 2, 0.5f}}) add_vertex(s.get(), p);
      add_triangle(s.get(), 0, 1, 2, m);
    } else {
      add_quad(s.get(), {-1, -1, 0.5f}, {1, -1, 0.5f}, {1, 1, 0.5f}, {-1, 1, 0.5f}, m);
    }
    s->bind();
    CAPTURE(triangle);
    std::vector<LightPoint> one = points_of(*s, 1);
    REQUIRE(one.size() == 1);
    CHECK(length(one[0].position - Vec3{0, 0, 0.5f}) < 1e-6f);
    CHECK(one[0].direction == Vec3{0, 0, 1});
    for (std::uint32_t n = 1; n <= kPointsPerAreaLightMax; n += kEffortDivisor > 1 ? 13 : 1) {
      double x = 0, y = 0, square = 0;
      int quadrants[4] = {0, 0, 0, 0};
      for (const LightPoint& p : points_of(*s, n)) {
        CHECK((p.position.x > -1 && p.position.y > -1 && std::fabs(p.position.z - 0.5f) < 1e-6f));
        CHECK((triangle ? p.position.x + p.position.y < 1 : p.position.x < 1 && p.position.y < 1));
        x += double(p.position.x), y += double(p.position.y);
        square += double(p.position.x * p.position.x + p.position.y * p.position.y);
        ++quadrants[(p.position.x > 0) + 2 * (p.position.y > 0)];
      }
      CAPTURE(n);
      CHECK(std::hypot(x / n, y / n) < 2e-7);
      double spread = triangle ? 1 : 2.0 / 3;  // mean square of the distance to the centre over the whole surface
      CHECK(square / n == doctest::Approx(spread).epsilon(1.01 / n));
      if (n % 4 == 0 && !triangle)
        for (int q : quadrants) CHECK(std::abs(q - int(n) / 4) <= 2 + std::sqrt(n) / 2);
    }
  }
}

// Goal: a square lamp shines alike whichever vertices its two triangles begin with. Method: the points of every pair of
// rotations against those of the first, and their mean against the centre.
TEST_CASE("plan_lights_points_do_not_depend_on_the_first_vertices_of_a_square") {
  std::vector<LightPoint> expected;
  for (std::uint32_t rotations = 0; rotations < 9; ++rotations) {
    const std::uint32_t i = rotations % 3, k = rotations / 3;
    auto s = lamp_scene();
    const std::uint32_t m = add_material(s.get(), lamp(1));
    for (Vec3 p : {Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{1, 1, 0}, Vec3{-1, 1, 0}}) add_vertex(s.get(), p);
    const std::uint32_t first[3] = {0, 1, 2}, second[3] = {0, 2, 3};
    add_triangle(s.get(), first[i], first[(i + 1) % 3], first[(i + 2) % 3], m);
    add_triangle(s.get(), second[k], second[(k + 1) % 3], second[(k + 2) % 3], m);
    s->bind();
    const std::vector<LightPoint> points = points_of(*s, 5);
    if (rotations == 0) expected = points;
    REQUIRE(points.size() == expected.size());
    CAPTURE(rotations);
    Vec3 sum = {0, 0, 0};
    for (std::size_t p = 0; p < points.size(); ++p) {
      CHECK(length(points[p].position - expected[p].position) < 1e-6f);
      CHECK(points[p].direction == expected[p].direction);
      sum += points[p].position;
    }
    CHECK(length(sum) < 2e-6f);
  }
}

// Goal: a lamp of many triangles shines from its centre, whatever the number of points, even below that of its
// triangles. Method: closed form, squares cut into 3×3, 5×7 and 8×8 quads of unequal widths or triangles that form
// none, one of them so small that fourth powers of its lengths leave the range of float; every point lies on the lamp.
TEST_CASE("plan_lights_points_keep_the_centre_of_a_mesh") {
  for (float scale : {1.0f, 0x1p-40f})
    for (int cuts : {3, 5, 8})
      for (bool bent : {false, true}) {
        auto s = lamp_scene();
        const std::uint32_t m = add_material(s.get(), lamp(1));
        const int rows = cuts == 5 ? 7 : cuts;
        auto at = [&](int i, int of) {  // from −1 to 1
          const float x = static_cast<float>(i) / static_cast<float>(of);
          return (x + 0.4f * x * (1 - x)) * 2 - 1;
        };
        for (int row = 0; row < rows; ++row)
          for (int column = 0; column < cuts; ++column) {
            const float x0 = at(column, cuts), x1 = at(column + 1, cuts), y0 = at(row, rows), y1 = at(row + 1, rows);
            const Vec3 middle = {x0 + 0.3f * (x1 - x0), y0 + 0.6f * (y1 - y0), 0};
            const Vec3 corners[4] = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
            if (!bent)
              add_quad(s.get(), corners[0] * scale, corners[1] * scale, corners[2] * scale, corners[3] * scale, m);
            for (int side = 0; bent && side < 4; ++side) {
              const std::uint32_t a = add_vertex(s.get(), middle * scale);
              const std::uint32_t b = add_vertex(s.get(), corners[side] * scale);
              add_triangle(s.get(), a, b, add_vertex(s.get(), corners[(side + 1) % 4] * scale), m);
            }
          }
        s->bind();
        for (std::uint32_t n : kCounts) {
          Vec3 sum = {0, 0, 0};
          for (const LightPoint& p : points_of(*s, n)) {
            CHECK(max_component(abs(p.position)) <= scale * 1.000001f);
            CHECK(p.direction == Vec3{0, 0, 1});
            sum += p.position / scale;
          }
          CAPTURE(scale);
          CAPTURE(cuts);
          CAPTURE(bent);
          CAPTURE(n);
          CHECK(length(sum / static_cast<float>(n)) < 0.001f);
        }
      }
}

// Goal: the points of a pixel's samples divide a lamp like as many points of one sample. Method: closed form. Of a
// square, every point lies in a part of its own, all in their lamp's cell; of a sphere, whose shares span many
// triangles, on the surface. Their mean is the lamp's centre.
TEST_CASE("plan_lights_samples_have_points_of_their_own") {
  for (const std::uint32_t samples : {2u, 4u, 9u, 16u})
    for (const std::uint32_t n : {1u, 4u, 16u})
      for (const bool sphere : {false, true}) {
        auto s = lamp_scene();
        const std::uint32_t m = add_material(s.get(), lamp(1));
        if (sphere)
          add_sphere(s.get(), {0, 0, 0}, 1, 24, 16, m);
        else
          add_quad(s.get(), {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, m);
        s->bind();
        Settings settings = settings_for(0, 4, 3);
        settings.points_per_area_light = n, settings.samples_per_pixel = samples;
        auto test = make_renderer(s->scene, settings);
        const Lights& lights = test->renderer.frame.lights;
        REQUIRE(lights.points.count == n);
        REQUIRE(lights.sample_points.count == samples * n);
        CAPTURE(samples);
        CAPTURE(n);
        CAPTURE(sphere);
        const float cells = std::sqrt(static_cast<float>(n)), count = static_cast<float>(samples * n);
        std::set<std::pair<int, int>> parts;
        Vec3 sum = {0, 0, 0};
        for (std::uint32_t k = 0; k < lights.sample_points.count; ++k) {
          const LightPoint &p = lights.sample_points[k], &whole = lights.points[k % n];
          CHECK(p.intensity == whole.intensity);
          sum += p.position;
          if (sphere) {
            CHECK(length(p.position) == doctest::Approx(1).epsilon(0.03));
            continue;
          }
          const Vec3 offset = abs(p.position - whole.position) * cells;
          CHECK(std::max(offset.x, offset.y) < 1);
          const float parts_of_side = cells * static_cast<float>(samples) / 2;
          parts.insert({static_cast<int>((p.position.x + 1) * parts_of_side),
                        static_cast<int>((p.position.y + 1) * parts_of_side)});
        }
        if (!sphere) CHECK(parts.size() == lights.sample_points.count);
        CHECK(length(sum / count) < (sphere ? 0.8f / std::sqrt(count) : 1e-6f));
      }
}

// Goal: points are distributed by area. Method: closed form, two squares of one material, one nine times the other.
TEST_CASE("plan_lights_points_follow_the_area") {
  auto s = lamp_scene();
  std::uint32_t m = add_material(s.get(), lamp(1));
  add_quad(s.get(), {0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, m);
  add_quad(s.get(), {9, 0, 0}, {10, 0, 0}, {10, 1, 0}, {9, 1, 0}, m);
  s->bind();
  int small = 0;
  for (const LightPoint& p : points_of(*s, 100)) small += p.position.x > 8;
  CHECK(small == 10);
}

// Goal: the same points every time. Method: differential, bit for bit.
TEST_CASE("plan_lights_are_deterministic") {
  auto generated = generate_scene(kAllFeatures & ~bit(Feature::animation), 7);
  for (std::uint32_t n : kCounts) {
    std::vector<LightPoint> a = points_of(*generated, n), b = points_of(*generated, n);
    REQUIRE(a.size() == b.size());
    CHECK(a.size() == n + 3);
    CHECK(std::memcmp(a.data(), b.data(), a.size() * sizeof(LightPoint)) == 0);
  }
}

// Goal: a scene with too many points is refused before memory is taken for them. Method: at the limit and beyond.
TEST_CASE("plan_lights_refuse_more_points_than_fit") {
  auto s = lamp_scene();
  for (int i = 0; i < 16; ++i) {
    float x = static_cast<float>(i) * 3;
    add_quad(s.get(), {x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}, add_material(s.get(), lamp(1)));
  }
  s->bind();
  Settings settings;
  settings.points_per_area_light = kPointsPerAreaLightMax;
  std::uint32_t count;
  REQUIRE(light_point_count(s->scene, settings, kAllEffects, &count).ok);
  CHECK(count == kPointLightCountMax);
  CHECK(points_of(*s, kPointsPerAreaLightMax).size() == kPointLightCountMax);
  s->lights.resize(1);
  s->bind();
  Status status = light_point_count(s->scene, settings, kAllEffects, &count);
  CHECK_FALSE(status.ok);
  CHECK(std::string(status.message).find("per area light") != std::string::npos);
}

// Goal: the radiance bound holds on both sides of a two-sided light. Method: a wall at the same distance in front of
// and behind it: the same bound, and more than the light itself.
TEST_CASE("plan_lights_radiance_bound_knows_both_sides_of_a_light") {
  float bound[2];
  for (int side = 0; side < 2; ++side) {
    auto s = lamp_scene();
    Material two_sided = lamp(1), wall;
    two_sided.double_sided = true, wall.diffuse = {1, 1, 1};
    add_quad(s.get(), {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, add_material(s.get(), two_sided));
    float z = side ? -0.25f : 0.25f;
    add_quad(s.get(), {-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}, add_material(s.get(), wall));
    s->bind();
    bound[side] = radiance_bounds(make_renderer(s->scene, settings_for(0, 4, 3))->renderer.frame).after[0];
  }
  CHECK(bound[0] == bound[1]);
  CHECK(bound[0] > 2);
}

// Goal: the radiance bound holds where a lamp's closed form exceeds the light of its points. Method: a plate close to
// the corner of a wide lamp of one point, whose light is known: .8/π · 2 · a quarter of π, and ambient light besides.
TEST_CASE("plan_lights_radiance_bound_of_a_wide_lamp") {
  GeneratedScene s;
  Material plate, wide;
  plate.diffuse = {0.8f, 0.8f, 0.8f};
  wide.diffuse = {0, 0, 0}, wide.emission = {2, 2, 2};
  add_quad(&s, {-8, 8, 2}, {8, 8, 2}, {8, -8, 2}, {-8, -8, 2}, add_material(&s, wide));
  add_quad(&s, {7.9f, 7.9f, 1.99f}, {8, 7.9f, 1.99f}, {8, 8, 1.99f}, {7.9f, 8, 1.99f}, add_material(&s, plate));
  aim(&s, {0, -3, 1}, {0, 0, 0}, 60);
  s.scene.info.ambient = {2.5f, 2.5f, 2.5f};
  s.bind();
  Settings settings = settings_for(0, 4, 3);
  settings.points_per_area_light = 1;
  auto test = make_renderer(s.scene, settings);
  const float bound = radiance_bounds(test->renderer.frame).after[0];
  CHECK(bound > 2 + 0.8f * 2 * 0.2f);
  CHECK(bound < 2 + 0.8f * 2 * 1.1f);
}

// Goal: the radiance bound does not depend on the accelerator: a hierarchy leaves out only boxes that cannot count.
// Method: brute force, generated scenes with every kind of light and range.
TEST_CASE("plan_lights_radiance_bound_is_the_same_with_every_accelerator") {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    auto s = generate_scene(kAllFeatures & ~bit(Feature::supersampling), seed);
    Rng rng = make_rng(seed);
    for (Light& light : s->lights) light.range = seed % 3 ? 0 : 4 * next_float(&rng);
    for (Material& m : s->materials) m.double_sided = seed % 2;
    s->bind();
    Settings settings = settings_for(kAllFeatures, 4, 3);
    settings.points_per_area_light = 9;
    const RadianceBounds expected = radiance_bounds(make_renderer(s->scene, settings, &kBruteAccel)->renderer.frame);
    CAPTURE(seed);
    CHECK(expected.after[settings.ray_depth] > 0);
    for (const AccelInfo* info : kAccelList)
      CHECK((radiance_bounds(make_renderer(s->scene, settings, info)->renderer.frame) == expected));
  }
}
