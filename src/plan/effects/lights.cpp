#include "indirect/environment.h"
#include "indirect/environment_lights.h"
#include "plan/effects/rule.h"
#include "plan/effects/unobstructed.h"
#include "shade/point_groups.h"

namespace pocketray {
namespace {

EffectDecision decide_area_light(const EffectCall& c) {
  const Settings& settings = c.settings;
  const bool has_groups = c.census.emissive && !selects_lights(c) && settings.area_shadows == AreaShadows::adaptive &&
                          settings.points_per_area_light > kUndividedMax;
  if (!has_groups) return by_materials(c, c.census.emissive, "emit light", Invisible::black_emission);
  return decided(true, "%u of %u materials emit light: %u points each, all tested where partly hidden",
                 c.census.emissive, c.census.materials, settings.points_per_area_light);
}

EffectDecision by_lights(const EffectCall& c, LightKind kind, const char* what) {
  const EffectDecision decision = by_count(c.census.lights[static_cast<int>(kind)], what);
  if (kind == LightKind::directional || c.census.invisible[static_cast<int>(dark_light(kind))] > 0)
    return with_invisible(c, decision, dark_light(kind));
  return with_invisible(c, decision, distant_light(kind));
}

// Returns whether nothing casts a shadow, whatever the view. Normals other than a triangle's own let in light from
// below it, virtual lights lie where surfaces meet, and with many lights, shadow rays choose which of them count.
bool casts_no_shadow(const EffectCall& c) {
  const Census& census = c.census;
  if (census.has_normals || census.bumpy > 0 || selects_lights(c)) return false;
  if (c.indirect && (c.indirect->effects & bit(Effect::instant_radiosity))) return false;
  return !environment_of(c.scene) && is_unobstructed(c.scene);
}

EffectDecision decide_shadow(const EffectCall& c) {
  if (c.census.light_count == 0 && c.census.emissive == 0) return decided(false, "no light");
  if (c.census.scattering == 0) return decided(false, "no material scatters light");
  if (casts_no_shadow(c)) return decided(false, "nothing stands between a surface and a light");
  return decided(true, "lit, and %u of %u materials scatter", c.census.scattering, c.census.materials);
}

EffectDecision decide_source_selection(const EffectCall& c) {
  const std::uint32_t count = c.census.emissive + c.census.light_count;
  if (c.settings.light_tolerance == 0) return decided(false, "every light tested for shadows");
  if (selects_lights(c))
    return decided(true, "%u lights: the strongest tested for shadows, error ≤ %.3g of the light", count,
                   static_cast<double>(c.settings.light_tolerance));
  return decided(false, "%u light%s: each tested for shadows", count, count == 1 ? "" : "s");
}

EffectDecision decide_environment(const EffectCall& c) {
  const EnvironmentInfo* environment = environment_of(c.scene);
  if (!environment) return decided(false, "no environment");
  return decided(true, "%s%u×%u texels, radiance at most %.3g",
                 c.scene.info.default_lights != 0 ? "no light of the scene's own: a studio, " : "", environment->side,
                 environment->side, static_cast<double>(max_component(environment->radiance_max)));
}

// Environment shadows are traced for its diffuse light, per pixel.
EffectDecision decide_environment_shadow(const EffectCall& c) {
  if (!shows_environment(c)) return decided(false, "no environment");
  if (c.settings.indirect == IndirectChoice::none) return decided(false, "no indirect light requested");
  if (default_lights_cast_shadows(c.scene)) return decided(false, "the default lights cast shadows");
  if (c.settings.environment_shadows == 0) return decided(false, "--environment-shadows 0");
  return by_materials(c, c.census.diffuse, "are diffuse");
}

bool never(const EffectCall&) { return false; }

constexpr EffectRule kRules[] = {
    {Effect::area_light, decide_area_light},
    {Effect::point_light, [](const EffectCall& c) { return by_lights(c, LightKind::point, "point light"); }},
    {Effect::spot_light, [](const EffectCall& c) { return by_lights(c, LightKind::spot, "spot light"); }},
    {Effect::directional_light,
     [](const EffectCall& c) { return by_lights(c, LightKind::directional, "directional light"); }},
    {Effect::shadow, decide_shadow},
    {Effect::source_selection, decide_source_selection, selects_lights},
    {Effect::environment, decide_environment},
    {Effect::environment_shadow, decide_environment_shadow, never},  // it is on wherever it can be
};

}  // namespace

Array<const EffectRule> light_rules() { return {kRules, sizeof kRules / sizeof kRules[0]}; }

}  // namespace pocketray
