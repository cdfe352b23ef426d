#include "desktop/accuracy/plot_script.h"

#include <algorithm>

#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

PlotArea area_of(const PlotFrame& frame) {
  return {(frame.right - frame.left) * kPlotWidth / kCharacter, (frame.top - frame.bottom) * frame.height / kLine};
}

}  // namespace

std::string script_of(const std::string& name, int height, const std::string& data, const std::string& body) {
  return "# gnuplot " + name + ".gnuplot draws " + name + ".png and " + name + ".svg.\nreset\nset encoding utf8\n" +
         data + "do for [kind in 'png svg'] {\nif (kind eq 'png') {\n" +
         format("set terminal pngcairo size %d,%d font 'sans,%.1f' fontscale 2 linewidth 2 pointscale 2 noenhanced\n",
                2 * kPlotWidth, 2 * height, 0.75 * kPlotFont) +
         "} else {\n" +
         format("set terminal svg size %d,%d dynamic font 'sans-serif,%d' noenhanced\n", kPlotWidth, height,
                kPlotFont) +
         "}\nset output '" + name + ".'.kind\nunset label\n" + body + "unset output\n}\n";
}

std::string frame_commands(const PlotFrame& frame) {
  return format("set lmargin at screen %.4f\nset rmargin at screen %.4f\n", frame.left, frame.right) +
         format("set bmargin at screen %.4f\nset tmargin at screen %.4f\n", frame.bottom, frame.top) +
         "set border 3 lc rgb 'black'\nset tics nomirror out\nset grid lc rgb '#dddddd'\n";
}

std::string data_block(const std::string& name, const std::string& lines) {
  return "$" + name + " << EOD\n" + lines + "EOD\n";
}

std::string label_commands(const PlotFrame& frame, const std::vector<PlotPoint>& points,
                           const std::vector<std::string>& texts, const char* color) {
  constexpr const char* kAligns[] = {"left", "center", "right"};
  std::string commands;
  std::vector<Label> labels = place_labels(area_of(frame), points, texts);
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i].placed && !texts[i].empty())
      commands += "set label " + gnuplot_string(texts[i]) +
                  format(" at graph %.4f, graph %.4f %s front tc rgb '%s'\n", labels[i].at.x, labels[i].at.y,
                         kAligns[labels[i].align + 1], color);
  return commands;
}

std::string unclaimed_commands(const Axis& y, double limit, const std::string& text) {
  if (!(limit > y.low)) return "";
  double top = std::min(1.0, place_on(y, limit));
  return format(
             "set object 1 rectangle from graph 0, graph 0 to graph 1, graph %.4f behind fc rgb '#888888' "
             "fs transparent solid 0.2 noborder\n",
             top) +
         "set label " + gnuplot_string(text) +
         format(" at graph 0.01, graph 0 left offset 0,0.6 front tc rgb '%s'\n", kInk);
}

}  // namespace pocketray
