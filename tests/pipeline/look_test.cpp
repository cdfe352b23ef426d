// Deviations from the look that a scene brings or gets.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "base/fmath.h"
#include "plan/plan_scene.h"
#include "support/generated_scene.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

std::unique_ptr<TestRenderer> rendered(const Scene& scene, const Look& look, double seconds = 0) {
  Settings settings;
  settings.width = 32, settings.height = 24, settings.threads = 1;
  auto test = std::make_unique<TestRenderer>();
  test->block.reset(new std::uint8_t[settings.memory_bytes]);
  Renderer* renderer = &test->renderer;
  start_renderer(test->block.get(), settings.memory_bytes, settings, renderer);
  renderer->scene = scene;
  renderer->view.look = look;
  REQUIRE(plan_renderer(renderer, SceneStorage(), 0).ok);
  renderer->workers = start_workers(settings.threads);
  REQUIRE(build_renderer(renderer).ok);
  REQUIRE(render_frame(renderer, seconds).ok);
  return test;
}

Picture picture_of(const TestRenderer& test) { return Picture(test.renderer.image.begin(), test.renderer.image.end()); }

}  // namespace

// Goal: a background replaces that of the scene and the default one. Method: a scene without light or camera, and one
// with light; some pixel shows exactly that colour.
TEST_CASE("look_replaces_the_background") {
  for (std::uint32_t features : {0u, bit(Feature::point_light)}) {
    auto generated = generate_scene(features, 1);
    generated->cameras.clear();
    generated->bind();
    Look look;
    for (const Vec3& background : {Vec3{0.25f, 0.5f, 0.75f}, Vec3{0, 0, 0}}) {
      look.has_background = true, look.background = background;
      auto test = rendered(generated->scene, look);
      CHECK(test->renderer.scene.info.background == background);
      const Picture picture = picture_of(*test);
      CHECK(std::find(picture.begin(), picture.end(), background) != picture.end());
    }
  }
}

// Goal: a scene without light gets the lights asked for, a scene with light keeps its own, bit for bit. Method: the
// number of lights, and pictures of each choice.
TEST_CASE("look_chooses_the_light_of_scenes_without") {
  auto dark = generate_scene(0, 1);
  auto lit = generate_scene(bit(Feature::point_light), 1);
  std::vector<Picture> pictures, lit_pictures;
  for (LightChoice choice : {LightChoice::key, LightChoice::sun, LightChoice::none}) {
    Look look;
    look.light = choice;
    auto test = rendered(dark->scene, look);
    const Array<const Light>& lights = test->renderer.scene.lights;
    CHECK(lights.count == (choice == LightChoice::key ? kDefaultLightCount : choice == LightChoice::sun ? 1u : 0u));
    for (const Light& light : lights) CHECK(light.kind == LightKind::directional);
    CHECK(test->renderer.scene.info.ambient == default_ambient());
    pictures.push_back(picture_of(*test));
    lit_pictures.push_back(picture_of(*rendered(lit->scene, look)));
  }
  CHECK_FALSE(same_picture(pictures[0], pictures[1]));
  CHECK_FALSE(same_picture(pictures[0], pictures[2]));
  CHECK_FALSE(same_picture(pictures[1], pictures[2]));
  CHECK(same_picture(lit_pictures[0], lit_pictures[1]));
  CHECK(same_picture(lit_pictures[0], lit_pictures[2]));
}

// Goal: a field of view is that of every camera of the scene, moving ones included, and of no camera set afterwards.
// Method: pictures equal those of scenes whose cameras have it; still, and posed at a time.
TEST_CASE("look_sets_the_field_of_view") {
  for (std::uint32_t features : {0u, bit(Feature::animation)}) {
    CAPTURE(features);
    auto generated = generate_scene(features, 1);
    REQUIRE(!generated->cameras.empty());
    Look look;
    look.vertical_fov = radians(20);
    auto test = rendered(generated->scene, look, 0.5);
    CHECK(test->renderer.view.camera.vertical_fov == static_cast<float>(radians(20)));
    Camera own = test->renderer.view.camera;
    own.vertical_fov = 1;
    REQUIRE(set_camera(&test->renderer, own).ok);
    REQUIRE(render_frame(&test->renderer, 0.5).ok);
    CHECK(test->renderer.view.camera.vertical_fov == 1);
    const Picture asked = picture_of(*rendered(generated->scene, look, 0.5));
    for (Camera& camera : generated->cameras) camera.vertical_fov = static_cast<float>(radians(20));
    generated->bind();
    CHECK(same_picture(asked, picture_of(*rendered(generated->scene, Look(), 0.5))));
  }
}

// Goal: an environment that is left out, for a background or altogether, leaves its light: as an ambient term beside
// other lights, and in default lights where there are none. Method: pictures equal those of scenes that have this light
// themselves, bit for bit.
TEST_CASE("look_keeps_the_light_of_environments_left_out") {
  const TestEnvironment even = even_environment({0.5f, 0.25f, 0.125f});
  for (bool has_background : {false, true}) {
    Look look, background_only;
    look.environment = EnvironmentChoice::none;
    if (has_background) {
      look = Look();
      look.has_background = background_only.has_background = true;
      look.background = background_only.background = {0.1f, 0.2f, 0.3f};
    }
    for (std::uint32_t features : {0u, bit(Feature::point_light)}) {
      CAPTURE(features);
      auto generated = generate_scene(features, 1);
      Scene with = generated->scene, without = generated->scene;
      even.give(&with);
      auto test = rendered(with, look);
      CHECK(test->renderer.scene.environment_info.empty());
      CHECK(test->renderer.scene.info.default_lights == (features ? 0 : 1));
      if (features) without.info.ambient = even.info.irradiance[0];
      CHECK(test->renderer.scene.info.ambient == (features ? Vec3{0.5f, 0.25f, 0.125f} : default_ambient()));
      CHECK(same_picture(picture_of(*test), picture_of(*rendered(without, background_only))));
    }
  }
}

// Goal: in a studio, an environment beside default lights, these give a share of their light and alone cast shadows;
// without it, the scene is as if it had never been there. Method: what was planned; pictures.
TEST_CASE("look_puts_default_lights_into_a_studio") {
  const TestEnvironment even = even_environment({0.3f, 0.3f, 0.3f});
  auto dark = generate_scene(0, 1);
  dark->scene.info.background = {0, 0, 0};
  Scene studio = dark->scene;
  even.give(&studio);
  studio.info.default_lights = 1, studio.info.background = {0.3f, 0.3f, 0.3f};
  Look look;
  const auto test = rendered(studio, look), plain = rendered(dark->scene, look);
  const Renderer &in = test->renderer, &out = plain->renderer;
  REQUIRE(in.scene.lights.count == kDefaultLightCount);
  for (std::uint32_t i = 0; i < kDefaultLightCount; ++i)
    CHECK(in.scene.lights[i].intensity == out.scene.lights[i].intensity * kStudioLightShare);
  CHECK(is_zero(in.scene.info.ambient));
  CHECK(has(in.effects.mask, Effect::environment));
  CHECK_FALSE(has(in.effects.mask, Effect::environment_shadow));
  auto planned = [](const Renderer& renderer, const std::string& part) {
    return std::any_of(renderer.memory.plan.parts, renderer.memory.plan.parts + renderer.memory.plan.part_count,
                       [&](const MemoryPart& p) { return part == p.name; });
  };
  CHECK_FALSE(planned(in, "environment shadows"));
  look.light = LightChoice::none;
  const auto alone = rendered(studio, look);
  CHECK(has(alone->renderer.effects.mask, Effect::environment_shadow));
  CHECK(planned(alone->renderer, "environment shadows"));
  CHECK(alone->renderer.scene.lights.empty());
  look = Look(), look.environment = EnvironmentChoice::none;
  CHECK(same_picture(picture_of(*rendered(studio, look)), picture_of(*plain)));
  CHECK_FALSE(same_picture(picture_of(*test), picture_of(*plain)));
}
