// The plan of a sweep: the baseline, each value of each knob with all others as in the baseline, a covering set of
// combinations, and the methods of indirect light, each with its own settings.
#pragma once
#include <functional>

#include "base/status.h"
#include "desktop/accuracy/knob_list.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

struct SweepPoint {
  std::string knob, value;  // as in `Measured`
  Configuration configuration;
  double price = 1;         // rough frame time relative to the baseline
  std::string missing;      // why it is unavailable; empty: measure it
  bool is_default = false;  // equals the baseline, which is measured instead
  bool is_choice = true;    // can be chosen between frames on the baseline's screen, so it may join the front
  std::string indirect;     // method of indirect light, "none" without one; empty: unknown
};

// The points of a knob: first … first + count - 1.
struct SweptKnob {
  const Knob* knob;
  std::size_t first, count;
};

struct SweepPlan {
  std::vector<SweepPoint> points;  // the baseline first, then knob by knob, then the covering set
  std::vector<SweptKnob> knobs;
  std::vector<std::string> notes;  // skipped knobs and why; pairs that the covering set omits
};

// `can_be_had` fails if settings are not available in the scene. `price_limit`: maximum frame time of combinations,
// relative to the baseline. `ladder`: settings to measure besides the covering set. `effects_with`: the scene's effects
// with other settings; without it, methods of indirect light are not compared. `bakeable`: null to leave out the
// choices of `bake`.
SweepPlan plan_sweep(const std::string& scene, const EffectPlan& effects, const Configuration& baseline,
                     const std::function<Status(const Settings&)>& can_be_had, double price_limit,
                     const std::vector<Settings>& ladder = {},
                     const std::function<EffectMask(const Settings&)>& effects_with = nullptr,
                     const BakeableScene* bakeable = nullptr);

}  // namespace pocketray
