#include "plan/plan_effects.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"
#include "base/nearest_word.h"
#include "effect/effect_list.h"
#include "effect/setting_list.h"
#include "plan/effects/rule.h"
#include "plan/resolve.h"

namespace pocketray {
namespace {

// Visits the rules of all effects in the order in which they are applied.
template <class Visit>
void each_rule(Visit visit) {
  for (Array<const EffectRule> (*rules)() : {material_rules, light_rules, indirect_rules, picture_rules})
    for (const EffectRule& rule : rules()) visit(rule);
}

// Turns an effect on or off as --effects says; the reason then says so.
void apply_force(const EffectRule& rule, const EffectCall& call, EffectDecision* decision) {
  const bool forced_on = has(call.settings.forced_on, rule.effect) && (!rule.may_be_forced || rule.may_be_forced(call));
  const bool on = (decision->on || forced_on) && !has(call.settings.forced_off, rule.effect);
  if (on == decision->on) return;
  CHECK(decision->reason[0] != 0);
  const EffectDecision before = *decision;
  *decision = decided(on, "%s (%.60s)", on ? "forced on" : "forced off", before.reason);
}

}  // namespace

EffectPlan plan_effects(const Scene& scene, const Settings& settings) {
  CHECK(within(Quantity::contrast, settings.selective_contrast));
  CHECK(settings.resolution <= Resolution::half);
  const Census census = take_census(scene, settings);
  EffectPlan plan;
  const EffectCall call = {scene, settings, census, choose_indirect(scene, settings), plan};
  each_rule([&](const EffectRule& rule) { plan.decisions[static_cast<int>(rule.effect)] = rule.decide(call); });
  let_effects_yield(settings.forced_off, &plan);
  each_rule([&](const EffectRule& rule) {
    EffectDecision& decision = plan.decisions[static_cast<int>(rule.effect)];
    apply_force(rule, call, &decision);
    if (decision.on) plan.mask |= bit(rule.effect);
  });
  for (const EffectDecision& decision : plan.decisions) CHECK(decision.reason[0] != 0);  // every effect has a rule
  return plan;
}

namespace {

Status unknown_effect(const char* name, std::size_t name_count, bool minus) {
  NearestWord nearest(name, name_count);
  if (!minus)
    for (const char* word : {"auto", "all"}) nearest.offer(word);
  for (const EffectRow& row : kEffectList) nearest.offer(row.name);
  const int shown = static_cast<int>(name_count < 60 ? name_count : 60);
  if (nearest.name())
    return failure("--effects: there is no effect '%.*s', did you mean '%s'?", shown, name, nearest.name());
  return failure("--effects: there is no effect '%.*s'; `pocketray plan SCENE` lists the effects", shown, name);
}

}  // namespace

Status parse_effects(const char* text, Settings* settings) {
  CHECK(text != nullptr && settings != nullptr);
  settings->forced_on = settings->forced_off = 0;
  bool automatic = false, named = false;
  for (const char* at = text;;) {
    const char* end = std::strchr(at, ',');
    std::size_t count = end ? static_cast<std::size_t>(end - at) : std::strlen(at);
    bool minus = count > 0 && *at == '-';
    const char* name = at + minus;
    std::size_t name_count = count - minus;
    auto is = [&](const char* word) {
      return std::strlen(word) == name_count && std::memcmp(word, name, name_count) == 0;
    };
    EffectMask mask = 0;
    if (is("auto") && !minus) {
      automatic = true;
    } else if (is("all") && !minus) {
      mask = kAllEffects;
    } else {
      for (const EffectRow& row : kEffectList)
        if (is(row.name)) mask = bit(row.effect);
      if (!mask) return unknown_effect(name, name_count, minus);
    }
    if (minus) {
      settings->forced_off |= mask;
    } else {
      settings->forced_on |= mask;
      named |= mask != 0;
    }
    if (!end) break;
    at = end + 1;
  }
  if (named && !automatic) settings->forced_off |= kAllEffects & ~settings->forced_on;
  return success();
}

Status validate_settings(const Settings& settings) {
  RETURN_IF_ERROR(check_limit(Quantity::width, settings.width));
  RETURN_IF_ERROR(check_limit(Quantity::height, settings.height));
  RETURN_IF_ERROR(check_limit(Quantity::texture_side, settings.texture_side_max));
  for (const SettingRow& row : kSettingList) RETURN_IF_ERROR(check_setting(row, row.field.get(settings)));
  if (settings.threads >= 1 && settings.threads <= kThreadCountMax) return success();
  return failure("the number of threads is %u: it must lie in 1 … %u", settings.threads, kThreadCountMax);
}

}  // namespace pocketray
