// Plots of a sweep as gnuplot scripts with inline data: each draws NAME.png and NAME.svg in the current folder.
#pragma once
#include "desktop/accuracy/plot_script.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

// Name of the plot of the front: "front" by the sweep's judge, otherwise "front_physical" or "front_model".
std::string front_plot_name(const Sweep& sweep, Judge judge);
// ꟻLIP over time of all configurations, the Pareto front as a line with labels numbered from 1, and the reference's own
// error.
Plot front_plot(const Sweep& sweep, Judge judge);
// ꟻLIP against full light transport over time, the front of each method of indirect light as a line.
Plot method_plot(const Sweep& sweep);
// RMSE and ꟻLIP over time for a knob's values.
Plot knob_plot(const Sweep& sweep, const KnobFigures& knob);
// Price of .01 ꟻLIP for each knob.
Plot price_plot(const Sweep& sweep);

}  // namespace pocketray
