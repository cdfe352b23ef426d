// Scene + settings → effects to simulate, with reasons.
#pragma once
#include "base/status.h"
#include "effect/effect_plan.h"
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

// Decides every effect. Settings::forced_on and forced_off override the scene's needs; the reason then says so.
EffectPlan plan_effects(const Scene& scene, const Settings& settings);

// Parses a list as in --effects: "auto", "all" or names, each optionally preceded by "-", separated by commas.
// "auto,-shadow" means what the scene needs except shadows; "shadow,mirror" means only these two.
Status parse_effects(const char* text, Settings* settings);

// Checks every setting against base/limit_list.h.
Status validate_settings(const Settings& settings);

}  // namespace pocketray
