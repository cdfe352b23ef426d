// Drawing by gnuplot.
#pragma once
#include <string>
#include <vector>

namespace pocketray {

// Runs scripts, one after the other, in the folder that they are in. False: there is no gnuplot that did.
bool run_gnuplot(const std::string& folder, const std::vector<std::string>& scripts);

}  // namespace pocketray
