// Draws plots with gnuplot.
#pragma once
#include <string>
#include <vector>

namespace pocketray {

// Runs the scripts one after another in their folder. Returns false if gnuplot is missing or failed.
bool run_gnuplot(const std::string& folder, const std::vector<std::string>& scripts);

}  // namespace pocketray
