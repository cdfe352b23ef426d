#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "plan/plan_scene.h"
#include "shade/camera.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// Picture position of a point: −1 … 1 from edge to edge, or far outside if it lies behind the camera.
Vec2 project(const CameraRays& c, const Vec3& p) {
  Vec3d v = {double(p.x) - c.eye.x, double(p.y) - c.eye.y, double(p.z) - c.eye.z};
  auto along = [&](const Vec3& a) { return v.x * a.x + v.y * a.y + v.z * a.z; };
  double depth = along(c.forward);
  if (!(depth > 0)) return {9, 9};
  return {static_cast<float>(along(c.right) / dot(c.right, c.right) / depth),
          static_cast<float>(along(c.up) / dot(c.up, c.up) / depth)};
}

std::unique_ptr<GeneratedScene> dark_scene() {
  auto generated = generate_scene(0, 1);
  generated->cameras.clear();
  generated->bind();
  return generated;
}

}  // namespace

// Goal: the framing camera keeps the whole scene in view and fills the picture with it. Method: project the corners,
// for boxes of every shape, size and place and pictures of every aspect.
TEST_CASE("framing_camera_shows_all_corners") {
  const Box boxes[] = {{{-1, -1, -1}, {1, 1, 1}},
                       {{0, 0, 0}, {10, 0, 0.1f}},
                       {{0, 0, 0}, {0, 5, 0}},
                       {{100, 100, 100}, {101, 103, 102}},
                       {{-1e9f, -1e9f, 0}, {1e9f, 1e9f, 1}},
                       {{1e-9f, 0, 0}, {2e-9f, 1e-9f, 1e-9f}},
                       {{0, 0, 0}, {0.01f, 0.01f, 9}},
                       {{-5, 2, -5}, {5, 2, 5}}};
  for (const Box& box : boxes)
    for (std::uint32_t width : {32u, 100u, 133u, 400u, 900u}) {
      Camera camera = framing_camera(box, static_cast<float>(width) / 100.0f, normalize(Vec3{0.45f, 0.35f, 1.0f}));
      CameraRays rays;
      REQUIRE(make_camera_rays(camera, width, 100, &rays).ok);
      float widest = 0;
      for (int i = 0; i < 8; ++i) {
        Vec2 p = project(
            rays, {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y, i & 4 ? box.high.z : box.low.z});
        widest = std::max(widest, std::max(std::fabs(p.x), std::fabs(p.y)));
      }
      CAPTURE(width);
      CAPTURE(box.high.x);
      CHECK(widest <= 1);
      CHECK(widest >= 0.6f);
    }
}

// Goal: a scene with a single point, or none, still gets a working camera. Method: degenerate boxes.
TEST_CASE("framing_camera_is_defined_for_degenerate_bounds") {
  const Box boxes[] = {empty_box(), {{0, 0, 0}, {0, 0, 0}}, {{3, 4, 5}, {3, 4, 5}}};
  for (const Box& box : boxes) {
    CameraRays rays;
    CHECK(make_camera_rays(framing_camera(box, 1.33f, {0, 0, 1}), 4, 3, &rays).ok);
  }
}

// Goal: the automatic camera frames the whole box with any field of view, and fills the picture.
// Method: corners projected into the picture; the usual field of view gives the usual camera.
TEST_CASE("framing_camera_frames_with_any_field_of_view") {
  const Box box = {{-1, 0, -2}, {3, 1, 2}};
  const Vec3 backward = normalize(Vec3{0.4f, 0.3f, 1});
  for (double degrees : {0.5, 10.0, 40.0, 100.0, 170.0}) {
    CAPTURE(degrees);
    const Camera camera = framing_camera(box, 1.5f, backward, radians(degrees));
    CHECK(camera.vertical_fov == doctest::Approx(radians(degrees)));
    const Vec3 right = normalize(cross(Vec3{0, 1, 0}, backward)), up = cross(backward, right);
    const double slope = std::tan(radians(degrees) / 2);
    double reach = 0;
    for (int i = 0; i < 8; ++i) {
      const Vec3 c = Vec3{i & 1 ? 3.0f : -1, i & 2 ? 1.0f : 0, i & 4 ? 2.0f : -2} - camera.eye;
      const double depth = -static_cast<double>(dot(c, backward));
      REQUIRE(depth > 0);
      reach = std::max({reach, std::fabs(static_cast<double>(dot(c, up))) / (slope * depth),
                        std::fabs(static_cast<double>(dot(c, right))) / (1.5 * slope * depth)});
    }
    CHECK(reach < 1);
    CHECK(reach > 0.3);  // at 170°, the margin of 5 % of the distance is wide
  }
  CHECK(framing_camera(box, 1.5f, backward, radians(40)).eye == framing_camera(box, 1.5f, backward).eye);
}

// Goal: default lights are added only if nothing gives light, and then the scene is lit. Method: one source at a time.
TEST_CASE("default_lights_come_only_where_nothing_gives_light") {
  auto dark = dark_scene();
  CHECK_FALSE(has_light(dark->scene));
  Settings settings = settings_for(0, 16, 12);
  auto test = make_renderer(dark->scene, settings);
  CHECK(test->renderer.scene.info.default_lights == 1);
  CHECK(test->renderer.scene.info.default_camera == 1);
  CHECK(test->renderer.scene.lights.count == kDefaultLightCount);
  CHECK(test->renderer.scene.info.ambient == default_ambient());
  REQUIRE(render_frame(&test->renderer, 0).ok);
  float most = 0;
  for (const Vec3& p : test->renderer.image) most = std::max(most, max_component(p));
  CHECK(most > 0.3f);

  for (Feature source :
       {Feature::point_light, Feature::spot_light, Feature::directional_light, Feature::ambient, Feature::emission}) {
    auto lit = generate_scene(bit(source), 1);
    CAPTURE(static_cast<int>(source));
    CHECK(has_light(lit->scene));
    auto lit_test = make_renderer(lit->scene, settings);
    CHECK(lit_test->renderer.scene.info.default_lights == 0);
    CHECK(lit_test->renderer.scene.lights.count == lit->lights.size());
  }
  auto off = generate_scene(bit(Feature::point_light), 1);
  for (Light& light : off->lights) light.intensity = {0, 0, 0};
  off->bind();
  CHECK(has_light(off->scene));  // which the caller may switch on
  CHECK_FALSE(lights_itself(off->scene));
  auto unlit = dark_scene();
  for (Material& m : unlit->materials) m.unlit = 1;
  CHECK(has_light(unlit->scene));
  unlit->materials[0].unlit = 0;
  CHECK_FALSE(has_light(unlit->scene));

  Material idle;
  idle.emission = {1, 1, 1};
  add_material(dark.get(), idle);  // used by no triangle
  dark->bind();
  CHECK_FALSE(has_light(dark->scene));
}

namespace {

std::uint32_t add_emitter(GeneratedScene* s, float emission) {
  Material m;
  m.diffuse = {0, 0, 0}, m.emission = {emission, emission, emission};
  return add_material(s, m);
}

}  // namespace

// Goal: a lamp is one however dim, and gets no key and fill; a glow on a body is none. Method: a lamp above a floor and
// in a room, by powers of two of its emission; a small light on the outside of a box, which falls on nothing.
TEST_CASE("dim_lamps_light_a_model_and_a_glow_does_not") {
  for (float emission : {1e-6f, .01f, .5f, 1.0f, 2.0f})
    for (bool room : {false, true}) {
      CAPTURE(emission);
      CAPTURE(room);
      GeneratedScene s;
      const std::uint32_t white = add_material(&s, {});
      if (room)
        add_box(&s, {-1, 0, -1}, {1, 1.2f, 1}, white, true);
      else
        add_quad(&s, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, white);
      add_quad(&s, {-.3f, 1, -.3f}, {.3f, 1, -.3f}, {.3f, 1, .3f}, {-.3f, 1, .3f}, add_emitter(&s, emission));
      s.bind();
      CHECK(lights_itself(s.scene));
    }
  GeneratedScene glow;
  add_box(&glow, {-1, 0, -1}, {1, 1.2f, 1}, add_material(&glow, {}));
  add_quad(&glow, {-.2f, .5f, 1.01f}, {.2f, .5f, 1.01f}, {.2f, .7f, 1.01f}, {-.2f, .7f, 1.01f}, add_emitter(&glow, 1));
  for (Material& m : glow.materials) m.double_sided = 0;
  glow.bind();
  CHECK_FALSE(lights_itself(glow.scene));
}
