// What a sweep found, for the eye: strips, plots and a page.
#pragma once
#include <string>

#include "accuracy/result.h"
#include "base/status.h"

namespace pocketray {

// Writes index.html, which needs no other file, and beside it strip_KNOB.png and for each plot NAME.gnuplot, NAME.png
// and NAME.svg. The folder must exist. *drawn: whether there is a gnuplot that drew the plots; without one, the page
// has tables alone.
Status write_report(const std::string& folder, const Sweep& sweep, bool* drawn);

}  // namespace pocketray
