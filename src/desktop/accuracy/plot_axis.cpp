#include "desktop/accuracy/plot_axis.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

constexpr double kSpanMax = 1e12;  // maximum ratio of an axis; smaller values are drawn at its end

// Tics at 1, 2 and 5 of each decade; only at 1 if there are many decades.
std::string logarithmic_tics(const Axis& axis) {
  bool many = axis.high / axis.low > 1e3;
  std::vector<std::string> tics;
  if (axis.zero > 0) tics.push_back(format("'0' %.6g", axis.zero));
  double least = axis.zero > 0 ? 1.5 * axis.zero : axis.low;
  for (double decade = std::pow(10, std::floor(std::log10(axis.low))); decade <= axis.high; decade *= 10)
    for (double digit : {1.0, 2.0, 5.0}) {
      double value = digit * decade;
      if (value < least || value > axis.high || (many && digit > 1)) continue;
      tics.push_back(format("'%.6g' %.6g", value, value));
    }
  std::string list;
  for (const std::string& tic : tics) list += (list.empty() ? "" : ", ") + tic;
  return list;
}

struct Box {
  double left, bottom, right, top;
};
double overlap(const Box& a, const Box& b) {
  double x = std::min(a.right, b.right) - std::max(a.left, b.left);
  double y = std::min(a.top, b.top) - std::max(a.bottom, b.bottom);
  return x > 0 && y > 0 ? x * y : 0;
}

}  // namespace

Axis axis_of(const std::vector<double>& values, double limit, bool from_zero) {
  Axis axis;
  double least = 0, most = 0;
  bool zeros = false;
  for (double v : values) {
    CHECK(std::isfinite(v));
    if (v > 0)
      least = least > 0 ? std::min(least, v) : v, most = std::max(most, v);
    else
      zeros = true;
  }
  if (most == 0) return axis;
  least = std::max(least, most / kSpanMax);
  double shown = limit > 0 && limit < least && limit > least / 10 ? limit / 1.5 : least;
  if (most / least > kLogSpan) {
    double margin = std::pow(most / shown, 0.07);
    axis.logarithmic = true;
    if (zeros) axis.zero = shown / std::pow(margin, 2);
    axis.low = (zeros ? axis.zero : shown) / margin, axis.high = most * margin;
  } else if (from_zero || zeros) {
    axis.high = 1.15 * most;
  } else {
    double span = std::max(most - least, 0.1 * most);
    axis.low = std::max(0.0, 0.5 * (least + most) - 0.65 * span), axis.high = 0.5 * (least + most) + 0.65 * span;
  }
  return axis;
}

double drawn_value(const Axis& axis, double value) {
  return value > 0 ? std::max(value, axis.logarithmic ? axis.low : value) : axis.zero;
}

double place_on(const Axis& axis, double value) {
  CHECK_LT(axis.low, axis.high);
  value = drawn_value(axis, value);
  if (!axis.logarithmic) return (value - axis.low) / (axis.high - axis.low);
  return std::log(value / axis.low) / std::log(axis.high / axis.low);
}

std::string axis_commands(const Axis& axis, char name) {
  std::string commands = format("set %crange [%.6g:%.6g]\n", name, axis.low, axis.high);
  if (!axis.logarithmic) return commands;
  return commands + format("set logscale %c\nset %ctics (", name, name) + logarithmic_tics(axis) + ")\n";
}

std::vector<Label> place_labels(const PlotArea& area, const std::vector<PlotPoint>& points,
                                const std::vector<std::string>& labels) {
  CHECK_LE(labels.size(), points.size());
  // Offsets in characters and lines from the point, in order of preference.
  constexpr struct {
    double x, y;
    int align;
  } kPlaces[] = {{1, 0.6, -1}, {1, -0.6, -1}, {-1, -0.6, 1}, {-1, 0.6, 1},  {0, 1, 0},     {0, -1, 0},
                 {1.4, 0, -1}, {-1.4, 0, 1},  {1, 1.6, -1},  {1, -1.6, -1}, {-1, 1.6, 1},  {-1, -1.6, 1},
                 {0, 2, 0},    {0, -2, 0},    {1, 2.6, -1},  {-1, -2.6, 1}, {1, -2.6, -1}, {-1, 2.6, 1}};
  std::vector<Label> result;
  std::vector<Box> taken;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    Label best;
    Box best_box = {};
    double least = 1;  // as much as a character's cell: no room
    double width = static_cast<double>(labels[i].size());
    for (const auto& place : kPlaces) {
      double x = points[i].x * area.columns + place.x, y = points[i].y * area.lines + place.y;
      double left = x - 0.5 * width * (1 + place.align);
      Box box = {left, y - 0.5, left + width, y + 0.5};
      if (box.left < 0 || box.bottom < 0 || box.right > area.columns || box.top > area.lines) continue;
      double cost = 0;
      for (const Box& other : taken) cost += 100 * overlap(box, other);
      for (const PlotPoint& point : points) {
        double column = point.x * area.columns, line = point.y * area.lines;
        cost += 0.4 * overlap(box, {column - 0.6, line - 0.35, column + 0.6, line + 0.35});
      }
      if (cost >= least) continue;
      least = cost, best_box = box;
      best = {{x / area.columns, y / area.lines}, place.align, true};
    }
    if (best.placed) taken.push_back(best_box);
    result.push_back(best);
  }
  return result;
}

}  // namespace pocketray
