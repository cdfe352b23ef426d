// Scene + settings → which effects are simulated, and why.
#pragma once
#include "base/status.h"
#include "effect/effect_plan.h"
#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

// Decides every effect. Settings::forced_on and forced_off override what the scene calls for; the reason says so.
EffectPlan plan_effects(const Scene& scene, const Settings& settings);

// Reads a list as --effects takes it: "auto", "all" or names, each with an optional "-" before it, separated by commas.
// "auto,-shadow" is what the scene calls for without shadows; "shadow,mirror" is these two alone.
Status parse_effects(const char* text, Settings* settings);

// Checks every setting against base/limit_list.h.
Status validate_settings(const Settings& settings);

}  // namespace pocketray
