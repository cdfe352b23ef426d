#include "plan/resolve.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "effect/effect_list.h"
#include "plan/plan_effects.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

std::string notes_of(const Scene& scene, const Settings& settings, const char* aov = nullptr) {
  std::string all;
  const Notes notes = find_requests_without_effect(scene, {settings, nullptr, aov});
  for (int i = 0; i < notes.count; ++i) all += std::string(notes.text[i]) + "\n";
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
TEST_CASE("resolve_are_those_that_no_effect_reads") {
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
TEST_CASE("resolve_name_the_cause") {
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
TEST_CASE("resolve_name_what_interpolation_leaves_out") {
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

// Goal: requests without effect by other means than settings are told, too. Method: false colours, an effect that
// nothing calls for, and coherence of a still scene, beside requests that have an effect.
TEST_CASE("resolve_tells_each_request_without_effect") {
  const auto made = generate_scene(bit(Feature::ambient) | bit(Feature::texture), 1);
  const Scene& scene = made->scene;
  Settings settings;
  settings.samples_per_pixel = 4, settings.texture_filter = TextureFilter::nearest;
  CHECK(notes_of(scene, settings).empty());
  CHECK(notes_of(scene, settings, "depth") ==
        "--samples has no effect on --aov depth, which shows what the pixels' centres hit\n");
  settings = Settings();
  settings.forced_on = bit(Effect::environment_shadow) | bit(Effect::shadow);
  CHECK(notes_of(scene, settings) ==
        "--effects cannot turn on what lacks its cause: environment-shadow is off (no environment)\n");
  settings.forced_on = kAllEffects;
  CHECK(notes_of(scene, settings).empty());
  settings = Settings();
  settings.coherence = CoherenceMode::on;
  const Notes notes = find_requests_without_effect(scene, {settings, "nothing moves"});
  REQUIRE(notes.count == 1);
  CHECK(std::string(notes.text[0]) == "--coherence on has no effect: nothing moves");
}

// Goal: an effect yields to those that are on, and only to these. Method: each pair of effects as if the scene called
// for both, with the other one forced off or not.
TEST_CASE("resolve_lets_effects_yield") {
  for (const EffectRow& row : kEffectList)
    for (const EffectRow& other : kEffectList)
      for (EffectMask off : {EffectMask(0), bit(other.effect)}) {
        if (row.effect == other.effect) continue;
        EffectPlan plan;
        plan.decisions[static_cast<int>(row.effect)].on = plan.decisions[static_cast<int>(other.effect)].on = true;
        let_effects_yield(off, &plan);
        const bool yields = off == 0 && (row.yields_to & bit(other.effect));
        CHECK(plan.decisions[static_cast<int>(row.effect)].on == !yields);
        if (yields) CHECK(std::string(plan.decisions[static_cast<int>(row.effect)].reason) == other.because);
      }
}

// Goal: each rule about uses refuses what breaks it, in a line that says how to mend it, and nothing else. Method: each
// rule alone, broken and kept, with all that its uses need.
TEST_CASE("resolve_refuses_uses_that_break_a_rule") {
  for (const UseRule& rule : kUseRules) {
    Uses uses;
    uses.add(rule.use, true, "--given");
    for (const UseRule& more : kUseRules)
      if (more.needs && more.use == rule.use && &more != &rule) uses.add(more.other, true);
    uses.add(rule.other, !rule.needs);
    const Status refused = check_uses(uses);
    REQUIRE_FALSE(refused.ok);
    CAPTURE(std::string(refused.message));
    CHECK(std::string(refused.message).rfind("--given ", 0) == 0);
    CHECK(std::strchr(refused.message, ':') != nullptr);
    if (rule.needs) {
      uses.add(rule.other, true);
    } else {
      uses.mask &= ~bit(rule.other);
      if (contains(refused.message, rule.because)) CHECK(check_uses(uses).ok);
    }
    if (rule.needs) CHECK_FALSE(contains(check_uses(uses).message, rule.because));
  }
  CHECK(check_uses(Uses()).ok);
  Uses uses;
  uses.add(Use::budget, true, "--flip-max");
  uses.add(Use::crop, true);
  CHECK(std::string(check_uses(uses).message) == "--flip-max measures whole frames: drop --flip-max or --crop");
  uses = Uses();
  uses.add(Use::values, true);
  uses.add(Use::servers, true);
  CHECK(contains(check_uses(uses).message, ": drop --server, or write .png or .ppm"));
  uses = Uses();
  uses.add(Use::frame_rate, true);
  CHECK(std::string(check_uses(uses).message) ==
        "--fps is for sequences: add --frames 0:99 or --turntable 36, or drop --fps");
}
