#include "accuracy/plot_script.h"

#include "accuracy/text.h"

namespace pocketray {

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

}  // namespace pocketray
