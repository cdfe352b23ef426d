// Conclusions from a sweep, for reports.
#pragma once
#include <string>
#include <vector>

#include "desktop/accuracy/result.h"

namespace pocketray {

double ms_of(const Sweep& sweep, double ns_per_pixel);
bool has_figures(const Measured& m);             // time and ꟻLIP against the model
bool is_judged(const Measured& m, Judge judge);  // time and ꟻLIP against that reference

// Returns the configurations that can be chosen between frames and that no other beats both in time and, as far as the
// judge's noise allows to claim, in ꟻLIP, fastest first. Lists the baseline once, not under each knob's name.
std::vector<const Measured*> front_of(const Sweep& sweep, Judge judge);

// Returns whether any configuration was judged by that reference.
bool has_judged(const Sweep& sweep, Judge judge);
// Returns the methods of indirect light that were measured, in the order of the sweep.
std::vector<std::string> methods_of(const Sweep& sweep);
// Likewise for the configurations of a method, against the truth.
std::vector<const Measured*> method_front(const Sweep& sweep, const std::string& method);

// Settings that distinguish a configuration from others of its method: "samples 4, virtual-lights 256".
std::string own_settings(const Measured& m);

// ꟻLIP against the knob's judge.
double flip_by(const KnobFigures& knob, const Measured& m);

// Returns a knob's configurations with or without figures, in the order of its values.
std::vector<const Measured*> values_of(const Sweep& sweep, const std::string& knob);

// A knob's first and last value with figures, normally the least and the most accurate, and the baseline's value; null
// if missing.
struct KnobEnds {
  const Measured *worst = nullptr, *standard = nullptr, *best = nullptr;
};
KnobEnds ends_of(const Sweep& sweep, const std::string& knob);

// How much nearer to the knob's judge the best end is, in ꟻLIP, and whether that is claimed.
double gain_of(const KnobFigures& knob, const KnobEnds& ends);
bool gain_claimed(const KnobFigures& knob, const KnobEnds& ends);

// True if the ends differ in the bytes of rows sent by a render server but not in time.
bool is_paid_in_bytes(const KnobEnds& ends);

// "slope of its own RMSE over time −0.5 [−0.6, −0.4]; RMSE is off that law by 1 %; theory: …"; unknown parts are
// omitted.
std::string slope_text(const KnobFigures& knob);

// Says in one line what `bake --radiosity` would give, or why nothing.
std::string radiosity_text(const Sweep& sweep);

// Returns the knobs by rising price of accuracy, then those whose gain cannot be claimed, then those without a price.
std::vector<const KnobFigures*> knobs_by_price(const Sweep& sweep);

}  // namespace pocketray
