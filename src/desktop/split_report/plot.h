// Writes the figures of a split report: split.csv and, if gnuplot is installed, split.png.
#pragma once
#include <string>

#include "desktop/split_report/split_report.h"

namespace pocketray {

struct SplitPlot {
  std::string title;  // one line
  std::uint32_t pixel_count = 0;
};

Status write_split_csv(const std::string& folder, const SplitFigures& figures, std::uint32_t pixel_count);
// Also writes split.gnuplot, which redraws the plot. *drawn: whether gnuplot succeeded.
Status draw_split(const std::string& folder, const SplitPlot& plot, const SplitFigures& figures, bool* drawn);

}  // namespace pocketray
