// What a sweep measures: the baseline, each value of each knob with all others as in the baseline, and a covering set
// of several turned at once.
#pragma once
#include <functional>

#include "accuracy/knob_list.h"
#include "accuracy/result.h"
#include "base/status.h"

namespace pocketray {

struct SweepPoint {
  std::string knob, value;  // as in `Measured`
  Configuration configuration;
  double price = 1;         // frames of the baseline, roughly
  std::string missing;      // why it cannot be had; empty: it is to be measured
  bool is_default = false;  // as the baseline, which is measured in its place
  bool is_choice = true;    // between frames, on the baseline's screen: of such is the front made
};

// The points of a knob: first … first + count - 1.
struct SweptKnob {
  const Knob* knob;
  std::size_t first, count;
};

struct SweepPlan {
  std::vector<SweepPoint> points;  // the baseline first, then knob by knob, then the covering set
  std::vector<SweptKnob> knobs;
  std::vector<std::string> notes;  // knobs left out, and why; what the covering set does not cover
};

// `can_be_had` fails where settings cannot be had in the scene. `price_limit`: no point of several knobs takes more, in
// frames of the baseline. `ladder`: settings to be measured beside the covering set.
SweepPlan plan_sweep(const std::string& scene, const EffectPlan& effects, const Configuration& baseline,
                     const std::function<Status(const Settings&)>& can_be_had, double price_limit,
                     const std::vector<Settings>& ladder = {});

// What was found of a point so far.
struct PointFigures {
  bool has_errors = false;
  double flip = 0, flip_before = 0;
  PictureErrors errors;
  double instructions_per_pixel = kNotMeasured;
  std::vector<double> ns_per_pixel;  // one for each round
};

// Fills what follows from the figures, one for each point of the plan: sweep->measured with intervals and the front,
// sweep->knobs with slopes and prices. Takes the size of the picture and the reference's errors from *sweep.
void sum_up(const SweepPlan& plan, const std::vector<PointFigures>& figures, Sweep* sweep);

}  // namespace pocketray
