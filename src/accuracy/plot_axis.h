// Where the points of a plot are, and where their labels find room.
#pragma once
#include <string>
#include <vector>

namespace pocketray {

// The range of an axis: linear, or logarithmic where the values span more than kLogSpan. Zeros, which no logarithm has,
// stand on a logarithmic axis at `zero`, beneath all others.
constexpr double kLogSpan = 8;
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  double zero = 0;  // above 0: the axis is logarithmic and some value is not above 0
};

// For finite values. `limit`, unless 0, is a value to show, too, if that takes no more than a decade. From 0 on, if
// linear and `from_zero`; else a linear axis shows a tenth of the values about them at least.
Axis axis_of(const std::vector<double>& values, double limit, bool from_zero);

// The value as the axis draws it, and where that is: 0 at the low end, 1 at the high end.
double drawn_value(const Axis& axis, double value);
double place_on(const Axis& axis, double value);

// Commands of gnuplot that set this axis, 'x' or 'y': range, scale, tics.
std::string axis_commands(const Axis& axis, char name);

// Of a plot: width × height in characters, as wide and as high as those of the labels.
struct PlotArea {
  double columns = 0, lines = 0;
};
struct PlotPoint {
  double x = 0, y = 0;  // [0, 1], from the bottom left
};
struct Label {
  PlotPoint at;         // of its anchor
  int align = 0;        // -1: the text begins there, 0: its middle is there, 1: it ends there
  bool placed = false;  // there was room
};

// A label beside each of the first labels.size() points, none over another and as few as may be over points.
std::vector<Label> place_labels(const PlotArea& area, const std::vector<PlotPoint>& points,
                                const std::vector<std::string>& labels);

}  // namespace pocketray
