#include "base/check.h"
#include "effect/effect_list.h"
#include "effect/setting_list.h"
#include "indirect/environment.h"
#include "plan/effects/rule.h"

namespace pocketray {
namespace {

bool asks_for(const Settings& settings, const IndirectInfo& info) {
  return settings.indirect == indirect_choice(static_cast<Effect>(__builtin_ctzll(info.effects)));
}

const IndirectInfo& info_of(Effect effect) {
  for (const IndirectInfo& info : IndirectList::kInfos)
    if (info.effects & bit(effect)) return info;  // built or not
  CHECK(false);
  return IndirectList::kInfos[0];
}

// Methods represent the same light, so a plan has only one of them.
template <Effect effect>
EffectDecision decide_method(const EffectCall& c) {
  const IndirectInfo& info = info_of(effect);
  const bool has_any = info.use(c.scene) != IndirectUse::nothing;
  if (&info == c.indirect || !has_any || (c.settings.forced_off & info.effects))
    return decided(has_any, "%s", has_any ? info.present : info.absent);
  if (c.settings.indirect == IndirectChoice::none) return decided(false, "no indirect light requested");
  return decided(false, c.indirect ? "%s instead" : "%s", c.indirect ? c.indirect->name : info.present);
}

// --effects cannot force a method in place of the chosen one, nor radiosity in place of an environment's diffuse light.
template <Effect effect>
bool may_force_method(const EffectCall& c) {
  if (c.indirect) return (c.indirect->effects & bit(effect)) != 0;
  if (c.settings.indirect == IndirectChoice::none || effect == Effect::instant_radiosity) return false;
  return effect != Effect::radiosity || !environment_of(c.scene);
}

EffectDecision decide_ambient_gloss(const EffectCall& c) {
  if (c.settings.indirect == IndirectChoice::none) return decided(false, "no indirect light requested");
  if (shows_environment(c))
    return decided(false, "%s instead", kEffectList[static_cast<int>(Effect::environment)].name);
  const bool is_stored = c.indirect && (c.indirect->effects & bit(Effect::radiosity));
  if (!is_stored && is_zero(radiance_of_surroundings(c.scene.info))) return decided(false, "no ambient light or background");
  return by_materials(c, c.census.reflecting, "reflect the surroundings");
}

bool may_force_ambient_gloss(const EffectCall& c) { return c.indirect || c.settings.indirect != IndirectChoice::none; }

bool is_on(const EffectCall& c, Effect effect) { return c.plan.decisions[static_cast<int>(effect)].on; }

EffectDecision decide_occlusion(const EffectCall& c) {
  const bool has_light = is_on(c, Effect::ambient) || is_on(c, Effect::ambient_gloss) ||
                         (shows_environment(c) && c.settings.indirect != IndirectChoice::none);
  return has_light ? by_materials(c, c.census.occluded, "have an occlusion texture", Invisible::white_occlusion)
                   : decided(false, "no ambient light");
}

EffectDecision decide_second_uv(const EffectCall& c) {
  const std::uint32_t of_occlusion = is_on(c, Effect::occlusion) ? c.census.second_uv_occlusion : 0;
  return by_materials(c, c.census.second_uv + of_occlusion, "use second texture coordinates");
}

constexpr EffectRule kRules[] = {
    {Effect::ambient, decide_method<Effect::ambient>, may_force_method<Effect::ambient>},
    {Effect::radiosity, decide_method<Effect::radiosity>, may_force_method<Effect::radiosity>},
    {Effect::instant_radiosity, decide_method<Effect::instant_radiosity>, may_force_method<Effect::instant_radiosity>},
    {Effect::ambient_gloss, decide_ambient_gloss, may_force_ambient_gloss},
    {Effect::occlusion, decide_occlusion},
    {Effect::second_uv, decide_second_uv},
};

}  // namespace

Array<const EffectRule> indirect_rules() { return {kRules, sizeof kRules / sizeof kRules[0]}; }

const IndirectInfo* choose_indirect(const Scene& scene, const Settings& settings) {
  if (settings.indirect == IndirectChoice::none) return nullptr;
  const IndirectInfo* chosen = nullptr;
  for (const IndirectInfo& info : IndirectList::kInfos) {
    if (!info.effects || (settings.forced_off & info.effects) || info.use(scene) == IndirectUse::nothing) continue;
    if (asks_for(settings, info)) return &info;
    if (info.use(scene) == IndirectUse::automatic) chosen = &info;
  }
  return chosen;
}

}  // namespace pocketray
