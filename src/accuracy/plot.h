// Plots of a sweep, as scripts of gnuplot that hold their data: each draws NAME.png and NAME.svg where it is run.
#pragma once
#include <string>
#include <vector>

#include "accuracy/result.h"

namespace pocketray {

struct Plot {
  std::string name, script;  // "front"; the script's file is NAME.gnuplot
};

// ꟻLIP over time of all that was measured, the Pareto front as a line with labels numbered from 1, and what is
// not claimed.
Plot front_plot(const Sweep& sweep);
// RMSE and ꟻLIP over time along a knob's values.
Plot knob_plot(const Sweep& sweep, const KnobFigures& knob);
// What .01 of ꟻLIP costs by each knob.
Plot price_plot(const Sweep& sweep);

}  // namespace pocketray
