// Parts that all gnuplot scripts share.
#pragma once
#include <string>
#include <vector>

#include "desktop/accuracy/plot_axis.h"

namespace pocketray {

struct Plot {
  std::string name, script;  // "front"; the script's file is NAME.gnuplot
};

// Distinguishable by colour-blind readers [Okabe & Ito 2008, "Color Universal Design"], legible on black and on white.
constexpr const char* kPlotColors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                       "#56b4e9", "#e69f00", "#8c6bb1", "#b0a000"};
constexpr int kPlotColorCount = 8;

// Plots are drawn at this size in SVG and at twice this size in PNG, so that they are legible at a phone's width.
constexpr int kPlotWidth = 620, kPlotFont = 17;

struct PlotFrame {
  double left, right, bottom, top;  // edges of the plot area, as fractions of the whole
  int height;
};
std::string frame_commands(const PlotFrame& frame);

constexpr double kCharacter = 0.56 * kPlotFont, kLine = 1.25 * kPlotFont;  // pixels, of a label's text
constexpr const char* kInk = "#777777";                                    // for remarks beside the figures
// Labels beside the first points, as many as fit.
std::string label_commands(const PlotFrame& frame, const std::vector<PlotPoint>& points,
                           const std::vector<std::string>& texts, const char* color);
// Shades the area below the limit on the y axis if it is in the plot. The label goes to the bottom left, where points
// are rare: low error in little time.
std::string unclaimed_commands(const Axis& y, double limit, const std::string& text);

// A script that runs `body` for both kinds of file.
std::string script_of(const std::string& name, int height, const std::string& data, const std::string& body);

// Lines of figures as inline data $name.
std::string data_block(const std::string& name, const std::string& lines);

}  // namespace pocketray
