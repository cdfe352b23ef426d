#include "desktop/accuracy/plot.h"

#include <algorithm>
#include <cmath>

#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/plot_axis.h"
#include "desktop/accuracy/plot_script.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

constexpr int kSymbols[] = {7, 5, 9, 11, 13};

// Each text starts a new line.
std::vector<std::string> title_lines(const std::vector<std::string>& texts) {
  constexpr std::size_t kColumns = 60;
  std::vector<std::string> lines;
  for (const std::string& text : texts) {
    std::string line;
    for (std::size_t at = 0; at < text.size();) {
      std::size_t end = std::min(text.find(' ', at), text.size());
      if (!line.empty() && line.size() + end - at >= kColumns) lines.push_back(line), line.clear();
      line += (line.empty() ? "" : " ") + text.substr(at, end - at);
      at = end + 1;
    }
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}
std::string title_commands(const std::vector<std::string>& lines) {
  std::string title;
  for (const std::string& line : lines) title += (title.empty() ? "" : ".\"\\n\".") + gnuplot_string(line);
  return "set title " + (title.empty() ? "''" : title) + "\n";
}

std::string series_of(const std::vector<const Measured*>& points, const Sweep& sweep, Judge judge, const Axis& x,
                      const Axis& y) {
  std::string lines;
  for (const Measured* m : points)
    lines += format("%.8g %.8g\n", drawn_value(x, ms_of(sweep, m->ns_per_pixel.value)),
                    drawn_value(y, distance_to(*m, judge).flip));
  return lines;
}

// Configurations of one knob that have figures by the judge.
std::vector<const Measured*> shown_of(const Sweep& sweep, const std::string& name, Judge judge) {
  std::vector<const Measured*> shown;
  for (const Measured* m : values_of(sweep, name))
    if (is_judged(*m, judge)) shown.push_back(m);
  return shown;
}

bool has_price(const Sweep& sweep, const KnobFigures& knob) {
  return std::isfinite(knob.ms_per_flip) && knob.ms_per_flip > 0 && gain_claimed(knob, ends_of(sweep, knob.name));
}

}  // namespace

std::string front_plot_name(const Sweep& sweep, Judge judge) {
  return judge == sweep.judge ? "front" : std::string("front_") + name_of(judge);
}

Plot front_plot(const Sweep& sweep, Judge judge) {
  const std::string plot_name = front_plot_name(sweep, judge);
  std::vector<double> times, errors;
  for (const Measured& m : sweep.measured)
    if (is_judged(m, judge))
      times.push_back(ms_of(sweep, m.ns_per_pixel.value)), errors.push_back(distance_to(m, judge).flip);
  const double limit = figures_of(sweep, judge).flip;
  Axis x = axis_of(times, 0, false), y = axis_of(errors, limit, true);
  std::vector<std::string> names = {"several"};
  for (const KnobFigures& knob : sweep.knobs) names.push_back(knob.name);
  names.push_back("baseline");

  int key_rows = (static_cast<int>(names.size()) + 2) / 2, height = 594 + 22 * key_rows;
  PlotFrame frame = {0.16, 0.97, (114.0 + 22 * key_rows) / height, 1 - 52.0 / height, height};
  std::string data, plots;
  std::vector<const Measured*> front = front_of(sweep, judge);
  std::vector<PlotPoint> points;
  std::vector<std::string> labels;
  auto point_of = [&](const Measured& m) {
    return PlotPoint{place_on(x, ms_of(sweep, m.ns_per_pixel.value)), place_on(y, distance_to(m, judge).flip)};
  };
  for (const Measured* m : front) {
    points.push_back(point_of(*m));
    std::string name = m->knob == "baseline" ? "baseline" : m->knob == "several" ? "" : m->knob + " " + m->value;
    labels.push_back(std::to_string(labels.size() + 1) + (name.empty() ? "" : " " + name));
  }
  for (const Measured& m : sweep.measured)
    if (is_judged(m, judge) && std::find(front.begin(), front.end(), &m) == front.end()) points.push_back(point_of(m));
  if (!front.empty()) {
    data += data_block("front", series_of(front, sweep, judge, x, y));
    plots = "$front using 1:2 title 'Pareto front' with lines lw 2 lc rgb 'black'";
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<const Measured*> shown = shown_of(sweep, names[i], judge);
    if (shown.empty()) continue;
    std::string block = "knob" + std::to_string(i);
    data += data_block(block, series_of(shown, sweep, judge, x, y));
    std::string style =
        format("pt %d ps 0.9 lc rgb '%s'", kSymbols[(i + 4) % 5], kPlotColors[(i + 7) % kPlotColorCount]);
    if (names[i] == "several") style = "pt 7 ps 0.45 lc rgb '#999999'";
    if (names[i] == "baseline") style = "pt 3 ps 1.3 lw 2 lc rgb '#d62728'";
    plots += (plots.empty() ? "$" : ", \\\n  $") + block + " using 1:2 title " + gnuplot_string(names[i]) +
             " with points " + style;
  }
  if (plots.empty()) plots = "1/0 title 'nothing was measured'";
  std::string body = frame_commands(frame) + axis_commands(x, 'x') + axis_commands(y, 'y') +
                     "set title 'Error over time, against " + text_of(judge) +
                     "'\nset xlabel 'milliseconds per frame'\n" +
                     "set ylabel 'FLIP, lower is better' offset 1.2,0\nset key at screen 0.5, screen 0.01 center "
                     "bottom horizontal samplen 1 "
                     "maxcols 2\n" +
                     unclaimed_commands(y, limit, "the reference's own error") +
                     label_commands(frame, points, labels, "black") + "plot " + plots + "\n";
  return {plot_name, script_of(plot_name, frame.height, data, body)};
}

Plot knob_plot(const Sweep& sweep, const KnobFigures& knob) {
  std::vector<const Measured*> shown = shown_of(sweep, knob.name, knob.judge);
  const bool has_rmse = knob.judge == Judge::model;  // which the RMSE is against
  std::vector<double> costs, errors;
  bool in_bytes = is_paid_in_bytes(ends_of(sweep, knob.name));
  auto cost_of = [&](const Measured& m, double ns) { return in_bytes ? m.bytes_per_frame / 1000 : ms_of(sweep, ns); };
  for (const Measured* m : shown) {
    costs.push_back(cost_of(*m, m->ns_per_pixel.value)), errors.push_back(flip_by(knob, *m));
    if (has_rmse && std::isfinite(m->errors.rmse)) errors.push_back(m->errors.rmse);
  }
  const double limit = figures_of(sweep, knob.judge).flip;
  Axis x = axis_of(costs, 0, false), y = axis_of(errors, limit, true);
  std::vector<std::string> title = title_lines({knob.name + ": " + knob.what, slope_text(knob)});
  double above = 38 + 1.35 * kPlotFont * static_cast<double>(title.size()), height = 428 + above;
  PlotFrame frame = {0.16, 0.97, 120 / height, 1 - above / height, static_cast<int>(height)};
  std::string flip, rmse;
  std::vector<PlotPoint> points, others;
  std::vector<std::string> labels;
  for (const Measured* m : shown) {
    double cost = cost_of(*m, m->ns_per_pixel.value), at = drawn_value(x, cost);
    double low = std::max(x.low, std::min(at, cost_of(*m, m->ns_per_pixel.low)));
    double high = std::max(at, cost_of(*m, m->ns_per_pixel.high));
    flip += format("%.8g %.8g %.8g %.8g\n", at, drawn_value(y, flip_by(knob, *m)), low, high);
    points.push_back({place_on(x, cost), place_on(y, flip_by(knob, *m))});
    labels.push_back(m->value + (m->is_default ? "*" : ""));
    if (!has_rmse || !std::isfinite(m->errors.rmse)) continue;
    rmse += format("%.8g %.8g %.8g %.8g\n", at, drawn_value(y, m->errors.rmse), low, high);
    others.push_back({place_on(x, cost), place_on(y, m->errors.rmse)});
  }
  points.insert(points.end(), others.begin(), others.end());
  std::string name = "knob_" + file_word(knob.name), plots;
  auto add = [&](const char* block, const char* name_shown, const char* style) {
    std::string from = std::string("$") + block + " using ";
    plots += (plots.empty() ? "" : ", \\\n  ") + from + "1:2 title '" + name_shown + "' with linespoints lw 2 ps 1 " +
             style + ", \\\n  " + from + "1:2:3:4 notitle with xerrorbars ps 0 lw 1.5 " + style;
  };
  std::string data;
  if (!flip.empty()) data += data_block("flip", flip), add("flip", "FLIP", "pt 7 lc rgb '#d55e00'");
  if (!rmse.empty()) data += data_block("rmse", rmse), add("rmse", "RMSE", "pt 5 lc rgb '#0072b2'");
  if (plots.empty()) plots = "1/0 title 'nothing was measured'";
  std::string body = frame_commands(frame) + axis_commands(x, 'x') + axis_commands(y, 'y') + title_commands(title) +
                     "set xlabel '" +
                     (in_bytes ? "kilobytes per frame from a render server" : "milliseconds per frame") +
                     "' offset 0,0.3\nset ylabel 'error against " + text_of(knob.judge) + "' offset 1.2,0\n" +
                     "set key at screen 0.5, screen 0.01 center bottom horizontal samplen 2\n" +
                     unclaimed_commands(y, limit, "the reference's own FLIP") +
                     label_commands(frame, points, labels, "black") + "plot " + plots + "\n";
  return {name, script_of(name, frame.height, data, body)};
}

Plot price_plot(const Sweep& sweep) {
  std::vector<const KnobFigures*> knobs = knobs_by_price(sweep);
  std::vector<double> prices;
  for (const KnobFigures* knob : knobs)
    if (has_price(sweep, *knob)) prices.push_back(knob->ms_per_flip);
  Axis x = axis_of(prices, 0, true);
  if (x.logarithmic) x.low /= 2;
  std::size_t width = 4;
  for (const KnobFigures* knob : knobs) width = std::max(width, knob->name.size());
  int height = 150 + 34 * static_cast<int>(std::max<std::size_t>(knobs.size(), 1));
  double left = std::min(0.5, (static_cast<double>(width) + 2) * kCharacter / kPlotWidth);
  PlotFrame frame = {left, 0.86, 92.0 / height, 1 - 52.0 / height, height};
  std::string bars, names, labels;
  for (std::size_t i = 0; i < knobs.size(); ++i) {
    double price = knobs[i]->ms_per_flip, end = 0;
    KnobEnds ends_there = ends_of(sweep, knobs[i]->name);
    bool claimed = std::isfinite(price) && gain_claimed(*knobs[i], ends_there);
    std::string text = is_paid_in_bytes(ends_there) ? "paid in bytes, not in time"
                       : claimed                    ? "free: better and no slower"
                                                    : "no gain that can be claimed";
    if (has_price(sweep, *knobs[i])) {
      bars += format("%.8g %zu %.8g\n", x.low, i, price);
      text = figure(price), end = place_on(x, price);
    }
    names += (names.empty() ? "" : ", ") + gnuplot_string(knobs[i]->name) + format(" %zu", i);
    labels += "set label " + gnuplot_string(text) + format(" at graph %.4f, first %zu left offset 0.6,0\n", end, i);
  }
  std::string data = bars.empty() ? "" : data_block("prices", bars);
  std::string plots = bars.empty() ? "-1 notitle lc rgb '#ffffff'"
                                   : "$prices using (0.5*($1+$3)):2:1:3:($2-0.32):($2+0.32) notitle with boxxyerror "
                                     "fs solid 0.9 noborder lc rgb '#0072b2'";
  std::string body = frame_commands(frame) + axis_commands(x, 'x') +
                     format("set yrange [%zu.5:-0.5]\n", knobs.empty() ? 0 : knobs.size() - 1) + "set ytics (" + names +
                     ") scale 0\nset grid noytics\nset title 'Price of .01 FLIP'\n"
                     "set xlabel 'milliseconds per frame" +
                     (x.logarithmic ? ", logarithmic" : "") + "'\n" +
                     (bars.empty() ? "unset xtics\nunset xlabel\n" : "") + labels + "plot " + plots + "\n";
  return {"price", script_of("price", height, data, body)};
}

}  // namespace pocketray
