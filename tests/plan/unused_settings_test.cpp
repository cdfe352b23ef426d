#include "plan/unused_settings.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "plan/plan_effects.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

std::string notes_of(const Scene& scene, const Settings& settings) {
  std::string all;
  const UnusedSettings unused = find_unused_settings(scene, settings);
  for (int i = 0; i < unused.count; ++i) all += std::string(unused.notes[i]) + "\n";
  return all;
}

// A value of the row's sweep that differs from the default.
double other_value(const SettingRow& row) {
  const double standard = row.field.get(Quality());
  const bool may_be_0 = row.field.kind == SettingKind::choice;
  for (int i = 0; i < row.sweep.count; ++i)
    if (row.sweep.values[i] != standard && (may_be_0 || row.sweep.values[i] != 0)) return row.sweep.values[i];
  FAIL("no other value of ", row.name);
  return standard;
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

// Goal: no request without effect goes unanswered, and none with an effect is called useless. Method: each setting
// alone, in a scene that shows every feature and in one that shows none, against the effects that read it.
TEST_CASE("unused_settings_are_those_that_no_effect_reads") {
  const auto bare = generate_scene(0, 1), full = generate_scene(kAllFeatures, 1);
  for (const Scene* scene : {&bare->scene, &full->scene})
    for (const SettingRow& row : kSettingList) {
      CAPTURE(row.name);
      Settings settings;
      CHECK(notes_of(*scene, settings).empty());
      row.field.set(&settings, other_value(row));
      const EffectMask readers = row.seen_with == kAlways ? row.effects : row.seen_with;
      Settings standard;
      const EffectMask mask = plan_effects(*scene, settings).mask;
      const bool used = (mask & readers) || mask != plan_effects(*scene, standard).mask;
      const std::string told = notes_of(*scene, settings);
      CHECK(contains(told, (std::string("--") + row.name + " has no effect: ").c_str()) == !used);
    }
}

// Goal: the note names the cause. Method: settings of a method of indirect light that is off, and settings that a
// method turns off.
TEST_CASE("unused_settings_name_the_cause") {
  const auto made = generate_scene(bit(Feature::ambient) | bit(Feature::emission), 1);
  const Scene& scene = made->scene;
  Settings settings;
  settings.compensation = Compensation::rays;
  settings.virtual_lights = 128;
  std::string told = notes_of(scene, settings);
  CHECK(contains(told,
                 "--compensation has no effect: instant-radiosity is off (ambient instead); "
                 "--indirect instant-radiosity turns it on\n"));
  CHECK(contains(told, "--virtual-lights has no effect: instant-radiosity is off"));
  settings = Settings();
  settings.indirect = indirect_choice(Effect::instant_radiosity);
  settings.resolution = Resolution::half;
  settings.virtual_lights = 128;
  told = notes_of(scene, settings);
  CHECK(told == "--resolution has no effect: undersampling is off (instant radiosity needs every pixel)\n");
}

// Goal: what interpolation leaves out is named. Method: an environment beside selective rendering.
TEST_CASE("unused_settings_name_what_interpolation_leaves_out") {
  const auto made = generate_scene(0, 1);
  Scene scene = made->scene;
  EnvironmentInfo info = {};
  info.side = 8, info.radiance_max = {1, 1, 1};
  scene.environment_info = {&info, 1};
  Settings settings;
  REQUIRE(has(plan_effects(scene, settings).mask, Effect::environment_shadow));
  CHECK(notes_of(scene, settings).empty());
  settings.selective_contrast = 0.2f;
  CHECK(notes_of(scene, settings) == "--selective leaves out: environment-shadow\n");
  settings.environment_shadows = 64;
  CHECK(contains(notes_of(scene, settings),
                 "--environment-shadows has no effect: environment-shadow is off "
                 "(selective rendering interpolates pixels)\n"));
}
