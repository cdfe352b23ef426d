// The visual report of a sweep: strips, plots and a page.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/status.h"
#include "desktop/accuracy/plot_script.h"
#include "desktop/accuracy/result.h"

namespace pocketray {

// Runs gnuplot scripts one after another in their folder. Returns false if gnuplot is missing or failed.
using DrawScripts = std::function<bool(const std::string& folder, const std::vector<std::string>& scripts)>;

// Replaces a file atomically.
using WriteFile = std::function<Status(const std::string& path, const std::string& bytes)>;

// Writes NAME.gnuplot for each plot and draws NAME.png and NAME.svg. *drawn: whether gnuplot drew them; if so, *svgs
// receives each SVG's text by name.
Status draw_plots(const std::string& folder, const std::vector<Plot>& plots, const WriteFile& write,
                  const DrawScripts& draw, std::map<std::string, std::string>* svgs, bool* drawn);

// Writes the self-contained index.html, with strip_KNOB.png and, for each plot, NAME.gnuplot, NAME.png and NAME.svg.
// The folder must exist. *drawn: whether gnuplot drew the plots; without them, the page has only tables.
Status write_report(const std::string& folder, const Sweep& sweep, const WriteFile& write, const DrawScripts& draw,
                    bool* drawn);

}  // namespace pocketray
