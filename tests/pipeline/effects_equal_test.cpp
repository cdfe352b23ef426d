#include <doctest/doctest.h>

#include <string>

#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

bool auto_equals_all(const Scene& scene, Settings settings, double seconds) {
  Picture automatic = render_picture(scene, settings, seconds);
  settings.forced_on = kAllEffects;
  return same_picture(automatic, render_picture(scene, settings, seconds));
}

}  // namespace

// Goal: leaving out absent effects changes no bit. Method: differential, `--effects auto` against `--effects all`, on
// every built-in scene.
TEST_CASE("effects_auto_equals_all_on_builtin_scenes") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    auto built = build_builtin(list[i]);
    Settings settings;
    settings.width = 40, settings.height = 30;
    CAPTURE(std::string(list[i].name));
    CHECK(auto_equals_all(built->scene, settings, 0));
    if (is_animated(built->scene)) CHECK(auto_equals_all(built->scene, settings, 0.7));
  }
}

// Goal and method as above, on generated scenes: every combination of the features that kernels are instantiated for,
// every pair and triple of all features, and random sets.
TEST_CASE("effects_auto_equals_all_on_generated_scenes") {
  int wrong = 0, scenes = 0;
  std::uint32_t first_wrong = 0;
  for (std::uint32_t features : feature_sets()) {
    auto generated = generate_scene(features, features + 1);
    ++scenes;
    if (auto_equals_all(generated->scene, settings_for(features, 24, 18), 0.6)) continue;
    if (!wrong++) first_wrong = features;
  }
  CAPTURE(first_wrong);
  CHECK(wrong == 0);
  CHECK(scenes > effort(1000));
}

// Goal: the pictures compared above show their features; otherwise the comparison would prove nothing. Method: each
// feature alone changes the picture.
TEST_CASE("generated_scenes_show_each_feature") {
  std::uint32_t base = bit(Feature::point_light);
  Picture plain = render_picture(generate_scene(base, 9)->scene, settings_for(base, 24, 18), 0.6);
  for (int i = 0; i < kFeatureCount; ++i) {
    std::uint32_t features = base | 1u << i;
    if (features == base) features = 0;
    if (features == (base | bit(Feature::absorption))) continue;  // only visible inside glass
    if (features == (base | bit(Feature::mip_map)) || features == (base | bit(Feature::second_uv)))
      continue;  // of textures
    CAPTURE(i);
    CHECK_FALSE(
        same_picture(plain, render_picture(generate_scene(features, 9)->scene, settings_for(features, 24, 18), 0.6)));
  }
  std::uint32_t glass = base | bit(Feature::refraction), tinted = glass | bit(Feature::absorption);
  CHECK_FALSE(same_picture(render_picture(generate_scene(glass, 9)->scene, settings_for(glass, 24, 18)),
                           render_picture(generate_scene(tinted, 9)->scene, settings_for(tinted, 24, 18))));
  std::uint32_t textured = base | bit(Feature::texture), with_levels = textured | bit(Feature::mip_map);
  CHECK_FALSE(same_picture(render_picture(generate_scene(textured, 9)->scene, settings_for(textured, 24, 18)),
                           render_picture(generate_scene(with_levels, 9)->scene, settings_for(with_levels, 24, 18))));
  const std::uint32_t by_second = textured | bit(Feature::second_uv);
  CHECK_FALSE(same_picture(render_picture(generate_scene(textured, 9)->scene, settings_for(textured, 24, 18)),
                           render_picture(generate_scene(by_second, 9)->scene, settings_for(by_second, 24, 18))));
  CHECK(generate_scene(kAllFeatures, 1)->triangles.size() <= 300);
}
