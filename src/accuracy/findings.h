// What can be said of a sweep, for whoever shows it.
#pragma once
#include <string>
#include <vector>

#include "accuracy/result.h"

namespace pocketray {

double ms_of(const Sweep& sweep, double ns_per_pixel);
bool has_figures(const Measured& m);  // time and ꟻLIP

// The front's configurations, the fastest first. The baseline is among them once, not by the name of each knob.
std::vector<const Measured*> front_of(const Sweep& sweep);

// A knob's configurations with or without figures, in the order of its values.
std::vector<const Measured*> values_of(const Sweep& sweep, const std::string& knob);

// A knob's first and last value with figures, which should be its least and its most accurate, and the baseline's
// value; null where there is none.
struct KnobEnds {
  const Measured *worst = nullptr, *standard = nullptr, *best = nullptr;
};
KnobEnds ends_of(const Sweep& sweep, const std::string& knob);

// Whether the best end is better by more than the reference can tell.
bool gain_claimed(const Sweep& sweep, const KnobEnds& ends);

// "slope of its own RMSE over time −0.5 [−0.6, −0.4]; RMSE is off that law by 1 %; theory: …", as far as known.
std::string slope_text(const KnobFigures& knob);

// The knobs, those that buy accuracy for less first; then those whose gain cannot be claimed, then those without a
// price.
std::vector<const KnobFigures*> knobs_by_price(const Sweep& sweep);

}  // namespace pocketray
