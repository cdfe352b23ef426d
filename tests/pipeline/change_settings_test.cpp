// Settings that change between frames.
#include <doctest/doctest.h>

#include <cstring>
#include <functional>

#include "effect/setting_list.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

std::vector<Vec3> picture_of(Renderer* renderer) {
  REQUIRE(render_frame(renderer, 0).ok);
  return {renderer->image.begin(), renderer->image.end()};
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

}  // namespace

// Goal: exposure is measured on traced pixels: a picture with interpolated ones is as bright as one without. Method:
// differential, at a contrast that interpolates most pixels.
TEST_CASE("change_settings_keeps_the_measured_exposure") {
  auto generated = generate_scene(kAllFeatures, 3);
  Settings settings = settings_for(kAllFeatures, 60, 45);
  auto exact = make_renderer(generated->scene, settings);
  settings.selective_contrast = 1;
  auto interpolated = make_renderer(generated->scene, settings);
  CHECK(measure_exposure(&interpolated->renderer) == measure_exposure(&exact->renderer));
  settings.selective_contrast = 0, settings.resolution = Resolution::half;
  auto reconstructed = make_renderer(generated->scene, settings);
  CHECK(measure_exposure(&reconstructed->renderer) == measure_exposure(&exact->renderer));
}

// Goal: a renderer with changed settings equals one started with them. Method: scenes with every effect, started with
// the maximum of points per area light; change one setting after the other, in both directions; compare the bits of the
// picture with those of a fresh renderer.
TEST_CASE("change_settings_equals_a_fresh_start") {
  using Change = std::function<void(Settings*)>;
  std::vector<Change> changes = {[](Settings* s) { s->samples_per_pixel = 4; },
                                 [](Settings* s) { s->ray_depth = 1; },
                                 [](Settings* s) { s->points_per_area_light = 3; },
                                 [](Settings* s) { s->cut_off_levels = 8; },
                                 [](Settings* s) { s->texture_filter = TextureFilter::nearest; },
                                 [](Settings* s) { s->normals = NormalMode::flat; },
                                 [](Settings* s) { s->samples_per_pixel = 1; },
                                 [](Settings* s) { s->normals = NormalMode::as_scene; },
                                 [](Settings* s) { s->points_per_area_light = 7; }};
  for (const SettingRow& row : kSettingList) {  // each to its least accurate value and back
    changes.push_back([&row](Settings* s) { row.field.set(s, row.sweep.values[0]); });
    changes.push_back([&row](Settings* s) { row.field.set(s, row.field.get(Quality())); });
  }
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    std::uint32_t features = kAllFeatures & ~bit(Feature::supersampling);
    auto generated = generate_scene(features, seed);
    Settings settings = settings_for(features, 16, 12);
    settings.points_per_area_light = 9;
    Settings planned = settings;
    planned.resolution = Resolution::half;
    auto changed = make_renderer(generated->scene, planned);
    std::vector<Vec3> before = picture_of(&changed->renderer);
    int differing = 0;
    for (const Change& change : changes) {
      change(&settings);
      REQUIRE(change_settings(&changed->renderer, settings).ok);
      auto fresh = make_renderer(generated->scene, settings);
      std::vector<Vec3> now = picture_of(&changed->renderer);
      CHECK(same_bits(now, picture_of(&fresh->renderer)));
      CHECK(changed->renderer.effects.mask == fresh->renderer.effects.mask);
      differing += !same_bits(now, before);
      before = now;
    }
    CAPTURE(seed);
    CHECK(differing >= 6);  // the settings had an effect
  }
}

// Goal: changes beyond the plan are refused and change nothing. Method: more points per area light than at the start,
// and settings out of range; the picture before and after.
TEST_CASE("change_settings_refuses_what_was_not_planned") {
  std::uint32_t features = bit(Feature::emission);
  auto generated = generate_scene(features, 3);
  Settings settings = settings_for(features, 16, 12);
  settings.points_per_area_light = 4;
  auto test = make_renderer(generated->scene, settings);
  std::vector<Vec3> before = picture_of(&test->renderer);
  Settings more = settings;
  more.points_per_area_light = 5;
  Status refused = change_settings(&test->renderer, more);
  CHECK_FALSE(refused.ok);
  CHECK(std::strstr(refused.message, "planned for --area-lights 4: plan with --area-lights 5") != nullptr);
  test->renderer.memory.plan.planned_for.light_points += 60;  // as with room for more lights
  more.points_per_area_light = 9;
  refused = change_settings(&test->renderer, more);
  CHECK_FALSE(refused.ok);
  CHECK(std::strstr(refused.message, "plan with --area-lights 9") != nullptr);
  test->renderer.memory.plan.planned_for.light_points -= 60;
  Settings wrong = settings;
  wrong.ray_depth = kRayDepthMax + 1;
  CHECK_FALSE(change_settings(&test->renderer, wrong).ok);
  wrong = settings;
  wrong.cut_off_levels = -1;
  CHECK_FALSE(change_settings(&test->renderer, wrong).ok);
  wrong = settings;
  wrong.resolution = Resolution::checkerboard;
  refused = change_settings(&test->renderer, wrong);
  CHECK_FALSE(refused.ok);
  CHECK(std::strstr(refused.message, "plan with --resolution checkerboard") != nullptr);
  CHECK(test->renderer.settings.points_per_area_light == 4);
  CHECK(same_bits(picture_of(&test->renderer), before));
  generated->lights.assign(30, Light());
  generated->bind();
  settings.light_tolerance = 0;
  test = make_renderer(generated->scene, settings);
  settings.light_tolerance = 0.1f;
  refused = change_settings(&test->renderer, settings);
  CHECK_FALSE(refused.ok);
  CHECK(std::strstr(refused.message, "plan with --light-tolerance 0.1") != nullptr);
}
