#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "base/limits.h"
#include "effect/effect_list.h"
#include "effect/setting_list.h"
#include "plan/plan_effects.h"
#include "support/generated_scene.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

EffectMask plan_of(std::uint32_t features) {
  return plan_effects(generate_scene(features, 1)->scene, settings_for(features, 8, 6)).mask;
}

std::string reason(const EffectPlan& plan, Effect effect) { return plan.decisions[static_cast<int>(effect)].reason; }

struct Parsed {
  bool ok;
  EffectMask on, off;
  std::string message;
};
Parsed parse(const char* text) {
  Settings settings;
  settings.forced_on = settings.forced_off = 7;  // must be overwritten
  Status status = parse_effects(text, &settings);
  return {status.ok, settings.forced_on, settings.forced_off, status.message};
}

}  // namespace

// Goal: a scene gets exactly the effects it needs. Method: each feature alone against the effects it needs.
TEST_CASE("plan_effects_follow_the_scene") {
  struct Row {
    std::uint32_t features;
    EffectMask mask;
  };
  using E = Effect;
  using F = Feature;
  const Row rows[] = {
      {0, 0},
      {bit(F::specular), bit(E::specular)},
      {bit(F::mirror), bit(E::mirror)},
      {bit(F::refraction), bit(E::refraction)},
      {bit(F::refraction) | bit(F::absorption), bit(E::refraction) | bit(E::absorption)},
      {bit(F::thin), bit(E::refraction)},
      {bit(F::alpha_mask), bit(E::alpha_mask) | bit(E::texture)},
      {bit(F::alpha_blend), bit(E::alpha_blend)},
      {bit(F::emission), bit(E::emission) | bit(E::area_light) | bit(E::shadow)},
      {bit(F::texture), bit(E::texture)},
      {bit(F::texture) | bit(F::mip_map), bit(E::texture) | bit(E::mip_map)},
      {bit(F::mip_map), 0},  // of no texture
      {bit(F::normal_map) | bit(F::mip_map), bit(E::normal_map) | bit(E::mip_map)},
      {bit(F::vertex_color), bit(E::vertex_color)},
      {bit(F::smooth_normal), bit(E::smooth_normal)},
      {bit(F::ambient), bit(E::ambient)},
      {bit(F::ambient) | bit(F::specular), bit(E::ambient) | bit(E::specular) | bit(E::ambient_gloss)},
      {bit(F::point_light), bit(E::point_light) | bit(E::shadow)},
      {bit(F::spot_light), bit(E::spot_light) | bit(E::shadow)},
      {bit(F::directional_light), bit(E::directional_light) | bit(E::shadow)},
      {bit(F::animation), bit(E::animation)},
      {bit(F::supersampling), bit(E::supersampling)},
      {bit(F::one_sided), bit(E::back_face_culling)},
      {bit(F::metallic_roughness),
       bit(E::metallic_roughness) | bit(E::specular) | bit(E::mirror) | bit(E::ambient_gloss)},
      {bit(F::normal_map), bit(E::normal_map)},
      {bit(F::anisotropy), bit(E::anisotropy) | bit(E::specular) | bit(E::ambient_gloss)},
      {bit(F::clear_coat), bit(E::clear_coat) | bit(E::specular) | bit(E::mirror) | bit(E::ambient_gloss)},
      {bit(F::sheen), bit(E::sheen)},
      {bit(F::sheen) | bit(F::texture), bit(E::sheen) | bit(E::texture)},
      {bit(F::transmission_map), bit(E::transmission_map) | bit(E::refraction) | bit(E::mirror) | bit(E::texture)},
      {bit(F::rough_refraction),
       bit(E::rough_refraction) | bit(E::refraction) | bit(E::specular) | bit(E::ambient_gloss)},
      {bit(F::iridescence), bit(E::iridescence) | bit(E::specular) | bit(E::ambient_gloss)},
      {bit(F::diffuse_transmission), bit(E::diffuse_transmission)},
      {bit(F::diffuse_transmission) | bit(F::texture), bit(E::diffuse_transmission) | bit(E::texture)},
      {bit(F::occlusion), 0},  // nothing to take away
      {bit(F::occlusion) | bit(F::ambient), bit(E::occlusion) | bit(E::ambient)},
      {bit(F::second_uv), 0},  // no texture
      {bit(F::texture) | bit(F::second_uv), bit(E::texture) | bit(E::second_uv)},
      {bit(F::alpha_mask) | bit(F::second_uv), bit(E::texture) | bit(E::alpha_mask) | bit(E::second_uv)},
      {bit(F::normal_map) | bit(F::second_uv), bit(E::normal_map)},
      {bit(F::occlusion) | bit(F::second_uv), 0},
      {bit(F::occlusion) | bit(F::second_uv) | bit(F::ambient),
       bit(E::occlusion) | bit(E::ambient) | bit(E::second_uv)},
      // Stored, or by request.
      {kAllFeatures, kAllEffects & ~bit(E::radiosity) & ~bit(E::instant_radiosity) & ~bit(E::selective) &
                         ~bit(E::environment) & ~bit(E::environment_shadow) & ~bit(E::undersampling) &
                         ~bit(E::source_selection) & ~bit(E::edge_sampling)},
  };
  for (const Row& row : rows) {
    CAPTURE(row.features);
    CHECK(plan_of(row.features) == row.mask);
  }
}

// Goal: every decision states its reason, in the scene's own figures. Method: examples.
TEST_CASE("plan_effects_give_reasons") {
  std::uint32_t features = bit(Feature::mirror) | bit(Feature::point_light);
  EffectPlan plan = plan_effects(generate_scene(features, 1)->scene, settings_for(features, 8, 6));
  CHECK(reason(plan, Effect::mirror) == "1 of 11 materials mirror");
  CHECK(reason(plan, Effect::refraction) == "none of 11 materials transmit");
  CHECK(reason(plan, Effect::point_light) == "1 point light");
  CHECK(reason(plan, Effect::spot_light) == "no spot light");
  CHECK(reason(plan, Effect::supersampling) == "1 sample per pixel");
  CHECK(reason(plan, Effect::animation) == "nothing moves");
  for (const EffectDecision& d : plan.decisions) CHECK(std::strlen(d.reason) > 5);
  Settings settings = settings_for(features, 8, 6);
  settings.forced_on = bit(Effect::absorption), settings.forced_off = bit(Effect::mirror) | bit(Effect::animation);
  plan = plan_effects(generate_scene(features, 1)->scene, settings);
  CHECK(reason(plan, Effect::absorption) == "forced on (none of 11 materials absorb)");
  CHECK(reason(plan, Effect::mirror) == "forced off (1 of 11 materials mirror)");
  CHECK(reason(plan, Effect::animation) == "nothing moves");  // was off anyway
  CHECK(has(plan.mask, Effect::absorption));
  CHECK_FALSE(has(plan.mask, Effect::mirror));
  CHECK(reason(plan, Effect::selective) == "every pixel traced");
  CHECK(reason(plan, Effect::environment) == "no environment");
  settings.selective_contrast = 0.25f;
  plan = plan_effects(generate_scene(features, 1)->scene, settings);
  CHECK(reason(plan, Effect::selective) == "contrasts below 0.25 interpolated");
  CHECK(has(plan.mask, Effect::selective));
  CHECK(reason(plan, Effect::undersampling) == "all of the pixels traced");
  CHECK_FALSE(has(plan.mask, Effect::undersampling));
  settings.resolution = Resolution::checkerboard;
  CHECK(reason(plan_effects(generate_scene(features, 1)->scene, settings), Effect::undersampling) ==
        "half of the pixels traced");
  settings.resolution = Resolution::half;
  plan = plan_effects(generate_scene(features, 1)->scene, settings);
  CHECK(reason(plan, Effect::undersampling) == "a quarter of the pixels traced");
  CHECK(has(plan.mask, Effect::undersampling));
  settings.indirect = indirect_choice(Effect::instant_radiosity);
  plan = plan_effects(generate_scene(features, 1)->scene, settings);
  CHECK(reason(plan, Effect::selective) == "instant radiosity needs every pixel");
  CHECK(reason(plan, Effect::undersampling) == "instant radiosity needs every pixel");
  CHECK_FALSE(has(plan.mask, Effect::selective));
  CHECK_FALSE(has(plan.mask, Effect::undersampling));
}

// Goal: shadows from the environment are on where it lights something diffuse whose pixels are traced one by one, never
// forced. Method: each reason that speaks against them.
TEST_CASE("plan_effects_shadow_what_an_environment_lights") {
  const TestEnvironment even = even_environment({1, 1, 1});
  auto s = generate_scene(0, 1);
  auto reason_with = [&](void (*change)(Settings*)) {
    Settings settings = settings_for(0, 8, 6);
    settings.forced_on = bit(Effect::environment_shadow);
    change(&settings);
    const EffectPlan plan = plan_effects(s->scene, settings);
    const std::string text = reason(plan, Effect::environment_shadow);
    CHECK(has(plan.mask, Effect::environment_shadow) ==
          (text.find("are diffuse") != std::string::npos && text[0] != 'n'));
    return text;
  };
  CHECK(reason_with([](Settings*) {}) == "no environment");
  even.give(&s->scene);
  const std::string on = reason_with([](Settings*) {});
  CHECK(on.find(" are diffuse") != std::string::npos);
  CHECK(on[0] != 'n');
  CHECK(reason_with([](Settings* t) { t->environment_shadows = 0; }) == "--environment-shadows 0");
  CHECK(reason_with([](Settings* t) { t->indirect = IndirectChoice::none; }) == "no indirect light requested");
  CHECK(reason_with([](Settings* t) { t->selective_contrast = 0.1f; }) == "selective rendering interpolates pixels");
  CHECK(reason_with([](Settings* t) { t->resolution = Resolution::half; }) == "undersampling reconstructs pixels");
  CHECK(reason_with([](Settings* t) { t->forced_off = bit(Effect::environment); }) == "no environment");
  s->scene.info.default_lights = 1;
  CHECK(reason_with([](Settings*) {}).find(" are diffuse") != std::string::npos);  // a studio without lights
  const Light key;
  s->scene.lights = {&key, 1};
  CHECK(reason_with([](Settings*) {}) == "the default lights cast shadows");
  s->scene.info.default_lights = 0;
  const std::uint32_t stored[1] = {kNone};
  s->scene.radiosity_triangles = {stored, 1};
  CHECK(reason_with([](Settings*) {}) == "radiosity stores them");
  for (Material& m : s->materials) m.diffuse = {0, 0, 0};
  s->bind();
  s->scene.radiosity_triangles = {};
  even.give(&s->scene);
  CHECK(reason_with([](Settings*) {}).rfind("none of ", 0) == 0);
}

// Goal: source selection is on where there are many lights, never forced. Method: one light fewer, and as many as it
// takes; forced on and off; no tolerance.
TEST_CASE("plan_effects_select_among_many_lights") {
  auto s = generate_scene(bit(Feature::emission), 1);
  auto plan_with = [&](std::uint32_t lights, float tolerance, EffectMask on, EffectMask off) {
    s->lights.assign(lights, Light());
    s->bind();
    Settings settings = settings_for(0, 8, 6);
    settings.points_per_area_light = 64;
    settings.light_tolerance = tolerance, settings.forced_on = on, settings.forced_off = off;
    return plan_effects(s->scene, settings);
  };
  const EffectMask selection = bit(Effect::source_selection);
  EffectPlan plan = plan_with(kSelectedLightsMin - 2, 0.1f, 0, 0);
  CHECK(reason(plan, Effect::source_selection) == "15 lights: each tested for shadows");
  CHECK_FALSE(has(plan.mask, Effect::source_selection));
  CHECK_FALSE(has(plan_with(kSelectedLightsMin - 2, 0.1f, selection, 0).mask, Effect::source_selection));
  plan = plan_with(kSelectedLightsMin - 1, 0.1f, 0, 0);
  CHECK(reason(plan, Effect::source_selection) ==
        "16 lights: the strongest tested for shadows, error ≤ 0.1 of the light");
  CHECK(has(plan.mask, Effect::source_selection));
  CHECK_FALSE(has(plan_with(kSelectedLightsMin - 1, 0.1f, 0, selection).mask, Effect::source_selection));
  CHECK_FALSE(has(plan_with(kSelectedLightsMin - 1, 0, selection, 0).mask, Effect::source_selection));
  CHECK(reason(plan_with(90, 0, 0, 0), Effect::source_selection) == "every light tested for shadows");
}

// Goal: the plan says how an area light is tested for shadows. Method: few points, many, every one tested, among many
// lights.
TEST_CASE("plan_effects_say_how_area_lights_are_tested") {
  auto s = generate_scene(bit(Feature::emission), 1);
  Settings settings = settings_for(0, 8, 6);
  auto says = [&] { return reason(plan_effects(s->scene, settings), Effect::area_light); };
  auto is_adaptive = [&] { return says().find("points each, all tested where partly hidden") != std::string::npos; };
  settings.points_per_area_light = 5;
  CHECK_FALSE(is_adaptive());
  CHECK(says().find("emit light") != std::string::npos);
  settings.points_per_area_light = 256;
  CHECK(is_adaptive());
  CHECK(says().find("emit light: 256 points") != std::string::npos);
  settings.area_shadows = AreaShadows::every;
  CHECK_FALSE(is_adaptive());
  settings.area_shadows = AreaShadows::adaptive;
  s->lights.assign(kSelectedLightsMin, Light());
  s->bind();
  CHECK_FALSE(is_adaptive());
}

// Goal: --indirect chooses the method, --effects cannot add another to it. Method: an ambient scene and a scene without
// indirect light, every choice, with effects forced on and off.
TEST_CASE("plan_effects_have_the_chosen_indirect_light") {
  auto lit = generate_scene(bit(Feature::ambient), 1), dark = generate_scene(0, 1);
  Settings settings = settings_for(0, 8, 6);
  auto mask_of = [&](const Scene& scene, IndirectChoice choice) {
    settings.indirect = choice;
    return plan_effects(scene, settings).mask & kIndirectEffects;
  };
  const IndirectChoice ambient = indirect_choice(Effect::ambient);
  for (EffectMask forced_on : {EffectMask(0), kAllEffects}) {
    settings.forced_on = forced_on;
    CHECK(mask_of(lit->scene, IndirectChoice::none) == 0);
    CHECK(mask_of(lit->scene, ambient) == bit(Effect::ambient));
    CHECK(mask_of(lit->scene, IndirectChoice::automatic) == bit(Effect::ambient));
    CHECK(mask_of(dark->scene, IndirectChoice::none) == 0);
  }
  // A stored solution takes the place of the ambient term, which stands in for the same light.
  const std::uint32_t stored[1] = {kNone};
  for (auto* generated : {lit.get(), dark.get()}) generated->scene.radiosity_triangles = {stored, 1};
  for (EffectMask forced_on : {EffectMask(0), kAllEffects}) {
    settings.forced_on = forced_on;
    CHECK(mask_of(lit->scene, IndirectChoice::none) == 0);
    CHECK(mask_of(lit->scene, ambient) == bit(Effect::ambient));
    CHECK(mask_of(lit->scene, IndirectChoice::automatic) == bit(Effect::radiosity));
    CHECK(mask_of(lit->scene, indirect_choice(Effect::radiosity)) == bit(Effect::radiosity));
    CHECK(mask_of(dark->scene, IndirectChoice::automatic) == bit(Effect::radiosity));
  }
  settings.forced_on = 0, settings.forced_off = bit(Effect::radiosity);
  CHECK(mask_of(lit->scene, IndirectChoice::automatic) == bit(Effect::ambient));
  settings.forced_off = 0;
  CHECK(reason(plan_effects(lit->scene, settings), Effect::ambient) == "radiosity instead");
  for (auto* generated : {lit.get(), dark.get()}) generated->scene.radiosity_triangles = {};
  CHECK(mask_of(lit->scene, indirect_choice(Effect::radiosity)) == bit(Effect::ambient));
  for (int i = 0; i < kIndirectChoiceCount; ++i) CHECK(mask_of(dark->scene, static_cast<IndirectChoice>(i)) == 0);
  settings.indirect = IndirectChoice::none;
  CHECK(reason(plan_effects(lit->scene, settings), Effect::ambient) == "no indirect light requested");
  CHECK(reason(plan_effects(dark->scene, settings), Effect::ambient) == "no constant indirect light");
  settings.indirect = ambient, settings.forced_off = bit(Effect::ambient);
  EffectPlan off = plan_effects(lit->scene, settings);
  CHECK(reason(off, Effect::ambient) == "forced off (constant indirect light)");
  CHECK(off.mask == 0);
}

// Goal: unused materials need no effects. Method: a mirror material that no triangle uses.
TEST_CASE("plan_effects_ignore_unused_materials") {
  auto generated = generate_scene(0, 1);
  Material idle;
  idle.mirror = idle.transmission = idle.emission = {1, 1, 1};
  add_material(generated.get(), idle);
  generated->bind();
  CHECK(plan_effects(generated->scene, Settings()).mask == 0);
}

// Goal: the grammar of --effects. Method: valid lists and their meaning, and invalid ones.
TEST_CASE("parse_effects_reads_its_grammar") {
  CHECK((parse("auto").ok && parse("auto").on == 0 && parse("auto").off == 0));
  CHECK((parse("all").on == kAllEffects && parse("all").off == 0));
  Parsed without = parse("auto,-shadow");
  CHECK((without.ok && without.on == 0 && without.off == bit(Effect::shadow)));
  Parsed only = parse("shadow,mirror");
  CHECK((only.ok && only.on == (bit(Effect::shadow) | bit(Effect::mirror))));
  CHECK(only.off == (kAllEffects & ~only.on));
  Parsed added = parse("auto,texture");
  CHECK((added.on == bit(Effect::texture) && added.off == 0));
  Parsed most = parse("all,-smooth-normal,-alpha-mask");
  CHECK((most.ok && most.off == (bit(Effect::smooth_normal) | bit(Effect::alpha_mask))));
  Parsed less = parse("-shadow");
  CHECK((less.ok && less.on == 0 && less.off == bit(Effect::shadow)));
  for (const EffectRow& row : kEffectList) {
    CAPTURE(std::string(row.name));
    CHECK(parse(row.name).on == bit(row.effect));
  }
  for (const char* wrong : {"", "shadows", "shadow,", ",shadow", "shadow,,mirror", "-", "--shadow", "-auto", "-all",
                            "SHADOW", "shadow mirror", "sha"}) {
    CAPTURE(std::string(wrong));
    CHECK_FALSE(parse(wrong).ok);
  }
  CHECK(parse("auto,blooming").message.find("'blooming'") != std::string::npos);
}

// Goal: every setting outside its range is refused by name. Method: each limit and the values just beyond it.
TEST_CASE("validate_settings_names_what_is_out_of_range") {
  CHECK(validate_settings(Settings()).ok);
  struct Row {
    std::uint32_t Settings::*field;
    std::uint32_t low, high;
    const char* name;
  };
  const Row rows[] = {{&Settings::width, 1, kImageSideMax, "width"},
                      {&Settings::height, 1, kImageSideMax, "height"},
                      {&Settings::samples_per_pixel, 1, kSampleCountMax, "samples"},
                      {&Settings::ray_depth, 0, kRayDepthMax, "depth"},
                      {&Settings::points_per_area_light, 1, kPointsPerAreaLightMax, "area light"},
                      {&Settings::threads, 1, kThreadCountMax, "threads"}};
  for (const Row& row : rows) {
    CAPTURE(std::string(row.name));
    Settings settings;
    settings.*row.field = row.low;
    CHECK(validate_settings(settings).ok);
    settings.*row.field = row.high;
    CHECK(validate_settings(settings).ok);
    for (std::uint32_t wrong : {row.high + 1, row.low - 1, 0xFFFFFFFFu}) {
      settings.*row.field = wrong;
      Status status = validate_settings(settings);
      CHECK_FALSE(status.ok);
      CHECK(std::string(status.message).find(row.name) != std::string::npos);
      CHECK(std::string(status.message).find(std::to_string(row.high)) != std::string::npos);
    }
  }
}

// Goal: an environment is an effect of its own, in place of even surroundings, and lights what an occlusion map shades;
// --indirect none leaves only what rays see of it. Method: the plans of one scene.
TEST_CASE("plan_effects_shows_environments_instead_of_even_surroundings") {
  auto s = generate_scene(bit(Feature::metallic_roughness) | bit(Feature::occlusion), 3);
  s->scene.info.ambient = {0, 0, 0}, s->scene.info.background = {1, 1, 1};
  const TestEnvironment even = even_environment({1, 1, 1});
  even.give(&s->scene);
  Settings settings;
  EffectPlan plan = plan_effects(s->scene, settings);
  CHECK(reason(plan, Effect::environment) == "8×8 texels, radiance at most 1");
  CHECK(reason(plan, Effect::ambient_gloss) == "environment instead");
  CHECK(has(plan.mask, Effect::environment));
  CHECK_FALSE(has(plan.mask, Effect::ambient_gloss));
  CHECK(has(plan.mask, Effect::occlusion));
  settings.indirect = IndirectChoice::none;
  plan = plan_effects(s->scene, settings);
  CHECK(has(plan.mask, Effect::environment));
  CHECK_FALSE(has(plan.mask, Effect::occlusion));
  settings = Settings(), settings.forced_off = bit(Effect::environment);
  plan = plan_effects(s->scene, settings);
  CHECK_FALSE(has(plan.mask, Effect::environment));
  CHECK(has(plan.mask, Effect::ambient_gloss));
}
