// One rule per effect: what calls for it, and whether --effects may force it on.
#pragma once
#include "effect/effect_plan.h"
#include "indirect/indirect_list.h"
#include "plan/effects/census.h"

namespace pocketray {

// Input of the rules.
struct EffectCall {
  const Scene& scene;
  const Settings& settings;
  const Census& census;
  const IndirectInfo* indirect;  // method of indirect light; null: none
  const EffectPlan& plan;        // decisions of earlier rules, before any is forced
};

struct EffectRule {
  Effect effect;
  EffectDecision (*decide)(const EffectCall& call);
  bool (*may_be_forced)(const EffectCall& call) = nullptr;  // null: always
};

// Rules in the order in which they are applied.
Array<const EffectRule> material_rules();
Array<const EffectRule> light_rules();
Array<const EffectRule> indirect_rules();
Array<const EffectRule> picture_rules();

// Returns the method that --indirect asks for or, if the scene lacks what it needs, the last one that the scene has by
// default, as for auto; null: none.
const IndirectInfo* choose_indirect(const Scene& scene, const Settings& settings);

// A decision with its reason.
EffectDecision decided(bool on, const char* format, ...) __attribute__((format(printf, 2, 3)));
// On if `count` of the materials do what the verb says: "2 of 5 materials shine".
EffectDecision by_materials(const EffectCall& call, std::uint32_t count, const char* verb);
// If off, the reason also says how many have invisible content: "none of 5 materials emit (2 with a black texture)".
EffectDecision by_materials(const EffectCall& call, std::uint32_t count, const char* verb, Invisible invisible);
// On if there are any: "3 point lights".
EffectDecision by_count(std::uint32_t count, const char* what);
// Adds to the reason of an effect that is off.
EffectDecision with_invisible(const EffectCall& call, EffectDecision decision, Invisible invisible);

// True if enough lights are there that --light-tolerance applies.
bool selects_lights(const EffectCall& call);
// True if the scene has an environment that is not forced off.
bool shows_environment(const EffectCall& call);

}  // namespace pocketray
