#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "effect/effect_list.h"
#include "effect/effect_probe.h"
#include "effect/setting_list.h"
#include "golden/golden_frames.h"
#include "scene/builtin_helpers.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

std::uint64_t entries(Effect effect) { return effect_probe.entries[static_cast<int>(effect)].load(); }

// Renders with traps on the effects that are absent from the scene's own plan, which is returned in *mask.
Picture render_trapped(const Scene& scene, const Settings& settings, double seconds, EffectMask* mask) {
  effect_probe.allowed = kAllEffects;
  auto test = make_renderer(scene, settings);
  for (auto& count : effect_probe.entries) count = 0;
  *mask = test->renderer.effects.mask;
  effect_probe.allowed = *mask;
  Status status = render_frame(&test->renderer, seconds);
  effect_probe.allowed = kAllEffects;
  REQUIRE(status.ok);
  return Picture(test->renderer.image.begin(), test->renderer.image.end());
}

Picture render_all(const Scene& scene, Settings settings, double seconds) {
  settings.forced_on = kAllEffects;
  effect_probe.allowed = kAllEffects;
  return render_picture(scene, settings, seconds);
}

// The signal that ends a child which renders with a trap on one effect of the scene, or 0.
int signal_of_render_without(Effect effect, Renderer* renderer) {
  pid_t child = fork();
  if (child == 0) {
    rlimit no_core = {0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    std::signal(SIGABRT, SIG_DFL);
    effect_probe.allowed = kAllEffects & ~bit(effect);
    _exit(render_frame(renderer, 0.5).ok ? 0 : 1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

// Returns whether one of ten scenes of the same features enters an effect: things hide behind others, or face no light.
bool enters_elsewhere(std::uint32_t features, Effect effect) {
  for (std::uint32_t seed = 2; seed < 12; ++seed) {
    auto generated = generate_scene(features, features + seed);
    EffectMask mask;
    render_trapped(generated->scene, settings_for(features, 96, 72), 0.5, &mask);
    if (entries(effect) > 0) return true;
  }
  return false;
}

}  // namespace

// Goal: a build that traps on entering an absent effect renders the frames of the normal build. Method: golden hashes,
// which the normal build must match, too.
TEST_CASE("probe_builtin_scenes_render_the_golden_frames") {
  for (const GoldenFrame& golden : kGoldenFrames) {
    const BuiltinScene* builtin = find_builtin(golden.scene);
    REQUIRE(builtin);
    auto built = build_builtin(*builtin);
    Settings settings = golden_settings(built->scene);
    EffectMask mask;
    Picture picture = render_trapped(built->scene, settings, golden.seconds, &mask);
    CAPTURE(std::string(golden.scene));
    CHECK(mask != kAllEffects);
    CHECK(picture_hash(picture.data(), picture.size()) == golden.frame_hash);
  }
}

// Goal: absent effects are never entered, present ones are, and the frame equals that of a render with everything on.
// Method: counters and traps over generated scenes with all kinds of combinations.
TEST_CASE("probe_generated_scenes_enter_what_the_plan_has_and_nothing_else") {
  for (std::uint32_t features : feature_sets()) {
    if (features % 2 && features != kAllFeatures) continue;  // half of them: the pipeline suite has all
    // A glossy lobe is entered only where a light is.
    constexpr std::uint32_t kLit =
        bit(Feature::point_light) | bit(Feature::spot_light) | bit(Feature::directional_light) | bit(Feature::emission);
    constexpr std::uint32_t kNarrow = bit(Feature::transmission_map) | bit(Feature::rough_refraction) |
                                      bit(Feature::iridescence) | bit(Feature::diffuse_transmission);
    constexpr std::uint32_t kGlossy =
        bit(Feature::metallic_roughness) | bit(Feature::anisotropy) | bit(Feature::clear_coat) | kNarrow;
    if ((features & kGlossy) && !(features & kLit)) continue;
    auto generated = generate_scene(features, features + 1);
    Settings settings = settings_for(features, 24, 18);
    EffectMask mask;
    Picture picture = render_trapped(generated->scene, settings, 0.5, &mask);
    std::uint64_t counted[kEffectCount];
    for (int i = 0; i < kEffectCount; ++i) counted[i] = entries(static_cast<Effect>(i));
    CAPTURE(features);
    for (const EffectRow& row : kEffectList) {
      CAPTURE(std::string(row.name));
      // A cut-out pane may show nothing but holes.
      // The narrow lobes of glass and films may reflect nothing of a few lights.
      const bool may_be_unseen = (row.effect == Effect::texture && !has(features, Feature::texture)) ||
                                 (row.effect == Effect::specular && (features & kNarrow) && (features & kLit) != kLit);
      if (has(mask, row.effect))
        REQUIRE((counted[static_cast<int>(row.effect)] > 0 || may_be_unseen || enters_elsewhere(features, row.effect)));
      else
        REQUIRE(counted[static_cast<int>(row.effect)] == 0);
    }
    REQUIRE(same_picture(picture, render_all(generated->scene, settings, 0.5)));
  }
}

// Goal: the trap works: entering an effect that is not allowed ends the process. Method: death test of each effect in a
// child process, on a scene that has them all.
TEST_CASE("probe_traps_an_effect_that_is_not_allowed") {
  auto generated = generate_scene(kAllFeatures, 1);
  effect_probe.allowed = kAllEffects;
  auto test = make_renderer(generated->scene, settings_for(kAllFeatures, 24, 18));
  Settings settings = settings_for(kAllFeatures, 24, 18);
  settings.indirect = indirect_choice(Effect::instant_radiosity);
  auto with_virtual_lights = make_renderer(generated->scene, settings);
  Settings selective = settings_for(kAllFeatures, 24, 18);
  selective.selective_contrast = 0.25f, selective.resolution = Resolution::half;
  auto interpolated = make_renderer(generated->scene, selective);
  Settings plain = settings_for(kAllFeatures, 24, 18);
  plain.samples_per_pixel = 1, plain.edge_samples = 4;
  auto with_edges = make_renderer(generated->scene, plain);
  const TestEnvironment even = even_environment({1, 1, 1});
  Scene under_environment = generated->scene;
  even.give(&under_environment);
  auto with_environment = make_renderer(under_environment, settings_for(kAllFeatures, 24, 18));
  auto street = generate_scene(kAllFeatures, 1);
  street->lights.resize(kSelectedLightsMin, street->lights[0]);
  street->bind();
  auto with_many_lights = make_renderer(street->scene, settings_for(kAllFeatures, 24, 18));
  const EffectMask all = with_many_lights->renderer.effects.mask | interpolated->renderer.effects.mask |
                         with_virtual_lights->renderer.effects.mask | with_environment->renderer.effects.mask |
                         with_edges->renderer.effects.mask;
  REQUIRE(all == (kAllEffects & ~bit(Effect::radiosity)));  // nothing is stored
  for (const EffectRow& row : kEffectList) {
    if (!has(all, row.effect)) continue;
    CAPTURE(std::string(row.name));
    Renderer* renderer =
        row.effect == Effect::instant_radiosity                                         ? &with_virtual_lights->renderer
        : row.effect == Effect::environment || row.effect == Effect::environment_shadow ? &with_environment->renderer
        : row.effect == Effect::source_selection                                        ? &with_many_lights->renderer
        : row.effect == Effect::edge_sampling                                           ? &with_edges->renderer
        : row.effect == Effect::selective || row.effect == Effect::undersampling        ? &interpolated->renderer
                                                                                        : &test->renderer;
    CHECK(signal_of_render_without(row.effect, renderer) == SIGABRT);
  }
}
