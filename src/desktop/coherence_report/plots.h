// Plots of the savings of coherence, frame by frame.
#pragma once
#include "desktop/accuracy/plot_script.h"
#include "desktop/coherence_report/report.h"

namespace pocketray {

// Ratios to whole frames: rays and pixels, with those that changed; time. Both ways and the paper's table, as far as
// the report has them.
Plot rays_plot(const CoherenceReport& report);
Plot time_plot(const CoherenceReport& report);

}  // namespace pocketray
