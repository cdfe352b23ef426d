// Derives which features go together from the declarations of effects (effect/effect_list.h), settings
// (effect/setting_list.h) and uses (plan/use_list.h). No other file has rules about two features.
#pragma once
#include "base/status.h"
#include "effect/effect_plan.h"
#include "effect/setting_list.h"
#include "plan/use_list.h"
#include "scene/scene.h"

namespace pocketray {

// Turns off each effect that yields to another one that is on. Effects forced off do not count.
void let_effects_yield(EffectMask forced_off, EffectPlan* plan);

// Returns why coherence cannot follow frames with these effects, or null. `by_tables`: by the paper's method.
const char* unfollowed_because(EffectMask mask, bool by_tables = false);
// Returns why the light of a server's map cannot be added to frames with these effects, or null.
const char* unshared_because(EffectMask mask);
// Sets every setting that has pixels interpolated to the value that traces all.
void trace_all_pixels(Quality* quality);

// How frames are to be used.
struct Uses {
  UseMask mask = 0;
  const char* names[kUseCount] = {};  // as given on the command line; null: the row's
  void add(Use use, bool is_used, const char* name = nullptr) {
    if (is_used) mask |= bit(use), names[static_cast<int>(use)] = name;
  }
};
// Refuses uses of which one rules out another, or lacks another that it needs.
Status check_uses(const Uses& uses);

// A request for pictures of an opened scene.
struct Asked {
  const Settings& settings;
  const char* whole_because = nullptr;  // why coherence is not planned; null: it is
  const char* aov = nullptr;            // the false colours of first hits that replace the picture; null: none
};

constexpr int kNoteBytes = 256, kNoteMax = kSettingCount + kEffectCount + 1;
// Notes without the program's name, each terminated: "--compensation has no effect: …".
struct Notes {
  char text[kNoteMax][kNoteBytes];
  int count = 0;
};

// Finds the requests without effect. Compares the plan of the settings with plans in which one setting has its default:
// a setting has no effect if the effects are equal and none that reads it is on. Also names the effects that an
// interpolating setting (--selective, --resolution) leaves out. Settings at their defaults count as not requested.
Notes find_requests_without_effect(const Scene& scene, const Asked& asked);

}  // namespace pocketray
