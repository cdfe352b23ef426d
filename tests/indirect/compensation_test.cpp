// Compensation for the bound of virtual lights: its directions, what it gives back, and what it gives where nothing is
// lacking.
#include "shade/compensation.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/fmath.h"
#include "effect/setting_list.h"
#include "instant_light.h"
#include "support/divided_picture.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr float kAlbedo = 0.5f;

// A closed box of one albedo, lit by equal point lights in one place, of intensity π together.
struct Cell : GeneratedScene {
  explicit Cell(std::uint32_t light_count = 1) {
    Material grey;
    grey.diffuse = {kAlbedo, kAlbedo, kAlbedo};
    add_box(this, {-1, -1, -1}, {1, 1, 1}, add_material(this, grey), true);
    const float intensity = kPiF / static_cast<float>(light_count);
    for (std::uint32_t i = 0; i < light_count; ++i) {
      Light light = {};
      light.kind = LightKind::point, light.intensity = {intensity, intensity, intensity};
      lights.push_back(light);
    }
    aim(this, {0.1f, 0.05f, 0.9f}, {0, -0.2f, 0}, 70);
    bind();
  }
};

Settings cell_settings(std::uint32_t virtual_lights, Compensation compensation) {
  Settings settings = instant_settings(virtual_lights);
  settings.light_tolerance = 0, settings.compensation = compensation;
  return settings;
}

double mean_of(const Scene& scene, const Settings& settings) {
  std::unique_ptr<TestRenderer> t = rendered(scene, settings);
  double sum = 0;
  for (const Vec3& p : t->renderer.image) sum += static_cast<double>(p.y);
  return sum / t->renderer.image.count;
}

double mean_indirect(const Scene& scene, Settings settings) {
  const double all = mean_of(scene, settings);
  settings.indirect = IndirectChoice::none;
  return all - mean_of(scene, settings);
}

}  // namespace

// Goal: the directions of a pattern stand for the whole hemisphere, by the cosine, and so do those of any 2 × 2 pixels.
// Method: unit lengths; each ring once and each sector once, each quarter of both once in each four; moments.
TEST_CASE("compensation_directions_are_spread") {
  std::uint32_t rings = 0, sectors = 0, quarters = 0;
  Vec3d sum = {0, 0, 0};
  double square = 0;
  for (std::uint32_t place = 0; place < kPatternPixels; ++place) {
    CAPTURE(place);
    const Vec3d d = to_double(compensation_direction(place));
    CHECK(length(d) == doctest::Approx(1).epsilon(1e-6));
    CHECK(d.z > 0);
    const int ring = static_cast<int>(std::floor(16 * (1 - d.z * d.z)));
    const double turn = std::atan2(d.y, d.x) / (2 * kPi);
    const int sector = static_cast<int>(std::floor(16 * (turn < 0 ? turn + 1 : turn)));
    rings |= 1u << ring, sectors |= 1u << sector;
    if (place % 4 == 0) quarters = 0;
    quarters |= 1u << ring / 4 | 16u << sector / 4;
    if (place % 4 == 3) CHECK(quarters == 255);
    sum += d, square += d.z * d.z;
  }
  CHECK(rings == 0xFFFF);
  CHECK(sectors == 0xFFFF);
  CHECK(std::fabs(sum.x) < 1);
  CHECK(std::fabs(sum.y) < 1);
  CHECK(sum.z / 16 == doctest::Approx(2.0 / 3).epsilon(2e-3));
  CHECK(square / 16 == doctest::Approx(0.5).epsilon(1e-6));
}

// Goal: compensation gives back what the bound takes away, however few virtual lights there are. Method: the indirect
// light of a closed room, the mean over some numbers of lights; against that of many, whose bound takes little.
TEST_CASE("compensation_gives_back_what_the_bound_takes") {
  Cell cell;
  double without = 0, with = 0, expected = 0, usual = 0;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const std::uint32_t few = 32 + 12 * i, many = 400 + 16 * i;
    const double bounded = mean_indirect(cell.scene, cell_settings(few, Compensation::none));
    const double compensated = mean_indirect(cell.scene, cell_settings(few, Compensation::rays));
    CHECK(compensated > bounded);
    without += bounded / 8, with += compensated / 8;
    expected += mean_indirect(cell.scene, cell_settings(many, Compensation::rays)) / 8;
    usual += mean_indirect(cell.scene, cell_settings(many, Compensation::none)) / 8;
  }
  CAPTURE(without / expected);
  CAPTURE(with / expected);
  CHECK(std::fabs(expected - usual) < 0.02 * usual);
  CHECK(without < 0.96 * expected);
  CHECK(std::fabs(with - expected) < 0.02 * expected);
}

// Goal: its bound is a quarter of the other at first hits, and the same elsewhere.
TEST_CASE("compensation_lowers_the_bound_of_first_hits") {
  Cell cell;
  for (Compensation compensation : {Compensation::none, Compensation::rays}) {
    std::unique_ptr<TestRenderer> t = rendered(cell.scene, cell_settings(64, compensation));
    const VirtualLights& lights = *virtual_lights_of(t->renderer.frame.indirect);
    const float share = compensation == Compensation::rays ? 0.25f : 1;
    CHECK(lights.first_geometry_max == share * lights.geometry_max);
    CHECK(lights.geometry_max > 0);
  }
}

// Goal: of many lights, those that a pixel looks at stand for all. Method: one light, and as many as 40 in its place.
TEST_CASE("compensation_takes_many_lights_as_their_sum") {
  const Settings settings = cell_settings(64, Compensation::rays);
  Cell one;
  const double expected = mean_of(one.scene, settings);
  for (std::uint32_t count : {16u, 17u, 40u}) {
    CAPTURE(count);
    Cell many(count);
    CHECK(std::fabs(mean_of(many.scene, settings) - expected) < 0.01 * expected);
  }
}

// Goal: rays between a convex room's walls meet nothing. Method: shadows off changes no bit.
TEST_CASE("compensation_of_an_empty_room_needs_no_shadows") {
  Cell cell;
  Settings settings = cell_settings(64, Compensation::rays), without = settings;
  without.forced_off = bit(Effect::shadow);
  std::unique_ptr<TestRenderer> a = rendered(cell.scene, settings), b = rendered(cell.scene, without);
  std::size_t different = 0;
  for (std::size_t i = 0; i < a->renderer.image.count; ++i)
    different += !same_pixel(a->renderer.image[i], b->renderer.image[i]);
  CHECK(different == 0);
}

// Goal: what a ray meets casts and receives shadows. Method: a wall across the room hides the light from the viewer's
// half, where the virtual lights of the other half do not reach, either: hardly anything is left to give back.
TEST_CASE("compensation_is_shadowed") {
  Cell cell;
  add_box(&cell, {-0.98f, -0.98f, -0.4f}, {0.98f, 0.98f, -0.3f}, 0);
  cell.cameras[0].eye = {0, 0, -0.5f}, cell.cameras[0].target = {0, 0, -1};
  cell.bind();
  Settings settings = cell_settings(64, Compensation::rays), without = settings;
  without.forced_off = bit(Effect::shadow);
  const double hidden = mean_indirect(cell.scene, settings), open = mean_indirect(cell.scene, without);
  CHECK(open > 0);
  CHECK(hidden < 1e-3 * open);
}

// Goal: where virtual lights are far enough away that none is bounded, there is nothing to give back: a point's light
// is the same bit for bit, with the bound of compensation and with the usual one. Method: plates that face each other
// from beyond the reach of both bounds.
TEST_CASE("compensation_adds_nothing_where_nothing_is_lacking") {
  GeneratedScene scene;
  Material grey;
  grey.diffuse = {kAlbedo, kAlbedo, kAlbedo};
  const std::uint32_t material = add_material(&scene, grey);
  add_box(&scene, {-8, -8, -9}, {8, 8, -8}, material);
  add_box(&scene, {-8, -8, 8}, {8, 8, 9}, material);
  Light light = {};
  light.kind = LightKind::point, light.intensity = {9, 9, 9};
  scene.lights.push_back(light);
  aim(&scene, {0.1f, 0.05f, 0}, {0, 0, -8}, 10);
  scene.bind();
  std::unique_ptr<TestRenderer> a = rendered(scene.scene, cell_settings(64, Compensation::none)),
                                b = rendered(scene.scene, cell_settings(64, Compensation::rays));
  REQUIRE(virtual_lights_of(a->renderer.frame.indirect)->count > 8);
  std::size_t different = 0, lit = 0;
  for (std::size_t i = 0; i < a->renderer.image.count; ++i) {
    different += !same_pixel(a->renderer.image[i], b->renderer.image[i]);
    lit += max_component(a->renderer.image[i]) > 0;
  }
  CHECK(lit == a->renderer.image.count);
  CHECK(different == 0);
}
