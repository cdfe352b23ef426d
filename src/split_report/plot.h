// The figures of a split report as files: split.csv, and split.png where gnuplot is installed.
#pragma once
#include <string>

#include "split_report/split_report.h"

namespace pocketray {

struct SplitPlot {
  std::string title;  // what was measured, one line
  std::uint32_t pixel_count = 0;
};

Status write_split_csv(const std::string& folder, const SplitFigures& figures, std::uint32_t pixel_count);
// Writes split.gnuplot, too, which draws it again. *drawn: whether there is a gnuplot that did.
Status draw_split(const std::string& folder, const SplitPlot& plot, const SplitFigures& figures, bool* drawn);

}  // namespace pocketray
