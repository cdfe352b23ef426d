// What a sweep found, for the eye: strips, plots and a page.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "accuracy/result.h"
#include "base/status.h"

namespace pocketray {

// Runs scripts of gnuplot, one after the other, in the folder that they are in. False: there is no gnuplot that did.
using DrawScripts = std::function<bool(const std::string& folder, const std::vector<std::string>& scripts)>;

// Replaces a file as a whole or not at all.
using WriteFile = std::function<Status(const std::string& path, const std::string& bytes)>;

// Writes index.html, which needs no other file, and beside it strip_KNOB.png and for each plot NAME.gnuplot, NAME.png
// and NAME.svg. The folder must exist. *drawn: whether there is a gnuplot that drew the plots; without one, the page
// has tables alone.
Status write_report(const std::string& folder, const Sweep& sweep, const WriteFile& write, const DrawScripts& draw,
                    bool* drawn);

}  // namespace pocketray
