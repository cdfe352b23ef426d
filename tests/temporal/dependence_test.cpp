// What a pixel depends on besides the geometry in front of it: each case changes one thing.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "engine/frame.h"
#include "support/effort.h"
#include "temporal/moving_scene.h"

using namespace pocketray;

namespace {

struct Pair {
  std::unique_ptr<GeneratedScene> scene;
  std::unique_ptr<TestRenderer> whole, coherent;
};

Pair make_pair(std::unique_ptr<GeneratedScene> scene, Settings settings) {
  Pair pair;
  pair.scene = std::move(scene);
  pair.whole = make_renderer(pair.scene->scene, settings);
  settings.coherence = CoherenceMode::on;
  pair.coherent = make_renderer(pair.scene->scene, settings);
  return pair;
}

bool same_frames(const Pair& pair) {
  for (TestRenderer* each : {pair.whole.get(), pair.coherent.get()}) each->renderer.lights.lit_mask = ~EffectMask(0);
  REQUIRE(render_frame(&pair.whole->renderer, 0).ok);
  REQUIRE(render_frame(&pair.coherent->renderer, changes_at(0)).ok);
  const Array<Vec3>&a = pair.whole->renderer.image, &b = pair.coherent->renderer.image;
  return std::memcmp(a.data, b.data, a.bytes()) == 0;
}

std::string whole_because(const Pair& pair) {
  const char* why = pair.coherent->renderer.history.state.whole_because;
  return why ? why : "";
}

Material matte(float albedo) {
  Material m;
  m.diffuse = {albedo, albedo, albedo};
  return m;
}

void move_by(GeneratedScene* s, const Vec3& by) {
  for (Vec3& p : s->rest_positions) p += by;
}

}  // namespace

// Goal: what every pixel depends on makes a whole frame, with its reason. Method: one change at a time, with all
// effects.
TEST_CASE("dependence_on_camera_settings_and_surroundings_makes_whole_frames") {
  const std::uint32_t features = kAllFeatures & ~bit(Feature::supersampling);
  Pair pair = make_pair(generate_scene(features, 3), settings_for(features, 40, 30));
  struct Change {
    const char* because;
    void (*apply)(Renderer* renderer);
  };
  const Change changes[] = {
      {"no previous frame", [](Renderer*) {}},
      {"the camera moved",
       [](Renderer* renderer) {
         Camera camera = renderer->view.camera;
         camera.eye.x += 0.1f;
         REQUIRE(set_camera(renderer, camera).ok);
       }},
      {"the settings changed",
       [](Renderer* renderer) {
         Settings settings = renderer->settings;
         settings.ray_depth = 2;
         REQUIRE(change_settings(renderer, settings).ok);
       }},
      {"the exposure changed", [](Renderer* renderer) { renderer->view.exposure = 4; }},
      {"the surroundings changed",
       [](Renderer* renderer) {
         renderer->scene.info.background = {0.4f, 0.3f, 0.2f};
       }},
      {"the surroundings changed",
       [](Renderer* renderer) {
         renderer->scene.info.ambient = {0.3f, 0.1f, 0.2f};
       }},
  };
  for (const Change& change : changes) {
    CAPTURE(std::string(change.because));
    change.apply(&pair.whole->renderer);
    change.apply(&pair.coherent->renderer);
    CHECK(same_frames(pair));
    CHECK(whole_because(pair) == change.because);
    CHECK(same_frames(pair));
    CHECK(whole_because(pair) == "");
  }
}

// Goal: rays that were too dim to matter are traced once they may matter. Method: a faint mirror, and a box that comes
// close to a lamp far away from it: the bound on what the mirror may show rises.
TEST_CASE("dependence_on_the_radiance_bound_makes_a_whole_frame") {
  auto s = std::make_unique<GeneratedScene>();
  Material mirror = matte(0.5f);
  mirror.mirror = {1e-6f, 1e-6f, 1e-6f};
  add_quad(s.get(), {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, -2}, add_material(s.get(), mirror));
  const std::uint32_t first = vertex_count(*s);
  add_box(s.get(), {50, 0, 0}, {51, 1, 1}, add_material(s.get(), matte(0.5f)));
  let_move(s.get(), first);
  Light light;
  light.position = {50.5f, 10, 0.5f}, light.intensity = {5, 5, 5};
  s->lights.push_back(light);
  s->scene.info.background = {1, 1, 1};
  aim(s.get(), {0, 3, 3}, {0, 0, 0}, 30);
  s->bind();
  Pair pair = make_pair(std::move(s), settings_for(0, 40, 30));
  CHECK(same_frames(pair));
  CHECK(same_frames(pair));
  CHECK(whole_because(pair) == "");
  move_by(pair.scene.get(), {0, 8.99f, 0});  // 0.01 below the lamp
  CHECK(same_frames(pair));
  CHECK(whole_because(pair) == "the brightest light on a surface changed");
}

// Goal: among many lights, one that no surface faces still counts, as its group's bound depends on it. Method: it moves
// below a floor, to places of which some change pixels and some do not.
TEST_CASE("dependence_on_the_selection_of_lights_makes_a_whole_frame") {
  auto s = std::make_unique<GeneratedScene>();
  add_quad(s.get(), {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, add_material(s.get(), matte(0.5f)));
  const std::uint32_t first = vertex_count(*s);
  add_box(s.get(), {1, 0, 0}, {2, 1, 1}, add_material(s.get(), matte(0.5f)));
  let_move(s.get(), first);
  Rng rng = make_rng(1);
  for (int i = 0; i < 40; ++i) {
    Light light;
    light.position = {next_float(&rng) * 8 - 4, 0.5f + next_float(&rng), next_float(&rng) * 8 - 4};
    light.intensity = {1, 1, 1};
    s->lights.push_back(light);
  }
  s->lights.back().position.y = -1;
  aim(s.get(), {0, 3, 6}, {0, 0, 0}, 60);
  s->bind();
  Settings settings = settings_for(0, 40, 30);
  settings.light_tolerance = 0.3f;
  Pair pair = make_pair(std::move(s), settings);
  CHECK(same_frames(pair));
  int changed = 0;
  for (int i = 0; i < 12; ++i) {
    const Array<Vec3>& image = pair.whole->renderer.image;
    const std::vector<Vec3> before(image.begin(), image.end());
    pair.scene->lights.back().position = {static_cast<float>(i), -1 - static_cast<float>(i), 0};
    CHECK(same_frames(pair));
    CHECK(whole_because(pair) == "a light changed; light selection is recomputed");
    changed += std::memcmp(before.data(), image.data, image.bytes()) != 0;
  }
  CHECK(changed > 0);
  move_by(pair.scene.get(), {0.1f, 0, 0});
  CHECK(same_frames(pair));
  CHECK(whole_because(pair) == "");
}

// Goal: a lamp that changes its shape, but not its points, changes the light. Method: a square becomes a bar with the
// same centre and area; one point stands for it.
TEST_CASE("dependence_on_the_shape_of_a_lamp") {
  auto s = std::make_unique<GeneratedScene>();
  add_quad(s.get(), {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, add_material(s.get(), matte(0.5f)));
  const std::uint32_t first = vertex_count(*s);
  Material lamp = matte(0);
  lamp.emission = {4, 4, 4};
  add_quad(s.get(), {-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, add_material(s.get(), lamp));
  let_move(s.get(), first);
  aim(s.get(), {0, 1, 6}, {0, 0, 0}, 60);
  s->bind();
  Settings settings = settings_for(0, 40, 30);
  settings.points_per_area_light = 1;
  Pair pair = make_pair(std::move(s), settings);
  CHECK(same_frames(pair));
  const Array<Vec3>& image = pair.whole->renderer.image;
  const std::vector<Vec3> before(image.begin(), image.end());
  const LightPoint point = pair.whole->renderer.frame.lights.points[0];
  for (Vec3& p : pair.scene->rest_positions) p.x *= 2, p.z /= 2;
  CHECK(same_frames(pair));
  CHECK(whole_because(pair) == "");
  CHECK(std::memcmp(&point, &pair.whole->renderer.frame.lights.points[0], sizeof point) == 0);
  CHECK(std::memcmp(before.data(), image.data, image.bytes()) != 0);
}

// Goal: shadows of a lamp are followed where each sample has points of its own. Method: a box passes through the light
// of a lamp that rests, and of one that moves along; with samples everywhere, and at edges.
TEST_CASE("dependence_on_the_points_of_samples") {
  for (const bool at_edges : {false, true})
    for (const bool lamp_moves : {false, true}) {
      auto s = std::make_unique<GeneratedScene>();
      add_quad(s.get(), {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}, add_material(s.get(), matte(0.5f)));
      Material lamp = matte(0);
      lamp.emission = {4, 4, 4};
      const std::uint32_t shine = add_material(s.get(), lamp), first = vertex_count(*s);
      if (lamp_moves) add_quad(s.get(), {-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}, shine);
      add_box(s.get(), {-0.8f, 0.6f, -0.5f}, {0.2f, 0.9f, 0.5f}, 0);
      let_move(s.get(), first);
      if (!lamp_moves) add_quad(s.get(), {-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}, shine);
      aim(s.get(), {0, 2, 6}, {0, 0, 0}, 50);
      s->bind();
      Settings settings = settings_for(0, 48, 36);
      settings.points_per_area_light = 4;
      (at_edges ? settings.edge_samples : settings.samples_per_pixel) = 4;
      Pair pair = make_pair(std::move(s), settings);
      CAPTURE(at_edges);
      CAPTURE(lamp_moves);
      CHECK(same_frames(pair));
      const Lights& lights = pair.whole->renderer.frame.lights;
      CHECK(lights.sample_points.count == 4 * lights.points.count);
      for (int frame = 0; frame < effort(6); ++frame) {
        for (Vec3& p : pair.scene->rest_positions) p.x += 0.07f, p.z -= 0.03f;
        CAPTURE(frame);
        CHECK(same_frames(pair));
        CHECK(whole_because(pair) == "");
      }
    }
}

// Goal: a mirror shows shadows that move. Method: it shows a wall; what casts the shadow is seen neither directly nor
// in the mirror.
TEST_CASE("dependence_on_shadows_in_a_mirror") {
  auto s = std::make_unique<GeneratedScene>();
  Material mirror = matte(0);
  mirror.mirror = {0.9f, 0.9f, 0.9f};
  add_quad(s.get(), {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, add_material(s.get(), mirror));
  add_quad(s.get(), {-9, -9, 8}, {-9, 9, 8}, {9, 9, 8}, {9, -9, 8}, add_material(s.get(), matte(0.7f)));
  const std::uint32_t first = vertex_count(*s);
  add_box(s.get(), {-6, 5, 5}, {-5.2f, 5.8f, 5.8f}, 1);
  let_move(s.get(), first);
  Light light;
  light.position = {-12, 12, 2}, light.intensity = {200, 200, 200};
  s->lights.push_back(light);
  aim(s.get(), {0, 0, 3}, {0, 0, 0}, 30);
  s->bind();
  Pair pair = make_pair(std::move(s), settings_for(0, 48, 36));
  std::uint64_t traced = 0;
  for (int frame = 0; frame < 24; ++frame) {
    CHECK(same_frames(pair));
    if (frame > 0) CHECK(whole_because(pair) == "");
    if (frame > 0) traced += pair.coherent->renderer.history.state.pixels_traced;
    move_by(pair.scene.get(), {0.05f, -0.25f, 0});
  }
  CHECK(traced > 0);
}
