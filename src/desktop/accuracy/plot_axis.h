// Places the points of a plot and their labels.
#pragma once
#include <string>
#include <vector>

namespace pocketray {

// The range of an axis: linear, or logarithmic if the values span more than kLogSpan. A logarithmic axis draws zeros at
// `zero`, below all other values.
constexpr double kLogSpan = 8;
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  double zero = 0;  // above 0: the axis is logarithmic and some value is not above 0
};

// Range for finite values. Includes `limit`, unless 0, if that adds at most a decade. A linear axis starts at 0 if
// `from_zero`; otherwise it has a margin of at least a tenth of the values.
Axis axis_of(const std::vector<double>& values, double limit, bool from_zero);

// The value as drawn on the axis, and its place: 0 at the low end, 1 at the high end.
double drawn_value(const Axis& axis, double value);
double place_on(const Axis& axis, double value);

// gnuplot commands for this axis, 'x' or 'y': range, scale, tics.
std::string axis_commands(const Axis& axis, char name);

// Size of a plot in characters of its labels.
struct PlotArea {
  double columns = 0, lines = 0;
};
struct PlotPoint {
  double x = 0, y = 0;  // [0, 1], from the bottom left
};
struct Label {
  PlotPoint at;         // anchor
  int align = 0;        // -1: the text begins there, 0: is centred, 1: ends there
  bool placed = false;  // there was room
};

// Places a label beside each of the first labels.size() points, without overlaps and over as few points as possible.
std::vector<Label> place_labels(const PlotArea& area, const std::vector<PlotPoint>& points,
                                const std::vector<std::string>& labels);

}  // namespace pocketray
