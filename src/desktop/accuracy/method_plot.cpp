#include "desktop/accuracy/findings.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/plot.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

// Longer labels would cover the lines; the page's table lists them all.
constexpr std::size_t kLabelMax = 20;
constexpr double kLabelStep = 0.12;  // minimum distance of labelled points on a line, relative to the plot's width

}  // namespace

Plot method_plot(const Sweep& sweep) {
  const std::vector<std::string> methods = methods_of(sweep);
  std::vector<double> times, errors;
  for (const std::string& method : methods)
    for (const Measured* m : method_front(sweep, method))
      times.push_back(ms_of(sweep, m->ns_per_pixel.value)), errors.push_back(m->truth.flip);
  const double own = sweep.truth.flip;
  const Axis x = axis_of(times, 0, false), y = axis_of(errors, own, true);
  const int key_bottom = 86 + 28 * static_cast<int>(methods.size()), height = 440 + key_bottom;
  const PlotFrame frame = {0.16, 0.97, static_cast<double>(key_bottom) / height, 1 - 52.0 / height, height};
  std::string data, plots;
  std::vector<PlotPoint> points;
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    std::string lines;
    double labelled = -1;
    for (const Measured* m : method_front(sweep, methods[i])) {
      const double ms = ms_of(sweep, m->ns_per_pixel.value), flip = m->truth.flip;
      lines += format("%.8g %.8g\n", drawn_value(x, ms), drawn_value(y, flip));
      points.push_back({place_on(x, ms), place_on(y, flip)});
      const std::string label = own_settings(*m);
      const bool is_labelled = label.size() <= kLabelMax && place_on(x, ms) - labelled >= kLabelStep;
      if (is_labelled) labelled = place_on(x, ms);
      labels.push_back(is_labelled ? label : "");
    }
    const std::string block = format("method%zu", i);
    data += data_block(block, lines);
    plots += (plots.empty() ? "$" : ", \\\n  $") + block + " using 1:2 title " + gnuplot_string(methods[i]) +
             format(" with linespoints lw 2 pt 7 ps 0.8 lc rgb '%s'", kPlotColors[i % kPlotColorCount]);
  }
  if (plots.empty()) plots = "1/0 title 'nothing was measured'";
  const std::string body = frame_commands(frame) + axis_commands(x, 'x') + axis_commands(y, 'y') +
                           "set title 'Error over time, by method of indirect light'\nset xlabel 'milliseconds per "
                           "frame'\nset ylabel 'FLIP against full light transport' offset 1.2,0\nset key at screen "
                           "0.5, screen 0.01 center bottom vertical samplen 2 maxcols 1\n" +
                           unclaimed_commands(y, own, "the reference's own error") +
                           label_commands(frame, points, labels, kInk) + "plot " + plots + "\n";
  return {"indirect", script_of("indirect", height, data, body)};
}

}  // namespace pocketray
