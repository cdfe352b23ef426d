// Conclusions from a sweep, for reports.
#pragma once
#include <string>
#include <vector>

#include "desktop/accuracy/result.h"

namespace pocketray {

double ms_of(const Sweep& sweep, double ns_per_pixel);
bool has_figures(const Measured& m);  // time and ꟻLIP

// Returns the front's configurations, fastest first. Lists the baseline once, not under each knob's name.
std::vector<const Measured*> front_of(const Sweep& sweep);

// Returns whether ꟻLIP is known against both kinds of reference.
bool knows_other(const Sweep& sweep);
// ꟻLIP against full light transport, whichever reference the sweep used.
double physical_flip(const Sweep& sweep, const Measured& m);
// Returns the methods of indirect light that were measured, in the order of the sweep.
std::vector<std::string> methods_of(const Sweep& sweep);
// Returns the configurations of a method that can be chosen between frames and that no other of the method beats both
// in time and in ꟻLIP against full light transport, fastest first.
std::vector<const Measured*> method_front(const Sweep& sweep, const std::string& method);

// Settings that distinguish a configuration from others of its method: "samples 4, virtual-lights 256".
std::string own_settings(const Measured& m);

// Returns a knob's configurations with or without figures, in the order of its values.
std::vector<const Measured*> values_of(const Sweep& sweep, const std::string& knob);

// A knob's first and last value with figures, normally the least and the most accurate, and the baseline's value; null
// if missing.
struct KnobEnds {
  const Measured *worst = nullptr, *standard = nullptr, *best = nullptr;
};
KnobEnds ends_of(const Sweep& sweep, const std::string& knob);

// True if the best end improves by more than the reference's own error allows to claim.
bool gain_claimed(const Sweep& sweep, const KnobEnds& ends);

// True if the ends differ in the bytes of rows sent by a render server but not in time.
bool is_paid_in_bytes(const KnobEnds& ends);

// "slope of its own RMSE over time −0.5 [−0.6, −0.4]; RMSE is off that law by 1 %; theory: …"; unknown parts are
// omitted.
std::string slope_text(const KnobFigures& knob);

// Returns the knobs by rising price of accuracy, then those whose gain cannot be claimed, then those without a price.
std::vector<const KnobFigures*> knobs_by_price(const Sweep& sweep);

}  // namespace pocketray
