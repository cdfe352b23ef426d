#include "desktop/split_report/plot.h"

#include <cstdarg>
#include <cstdio>
#include <vector>

#include "desktop/accuracy/gnuplot.h"
#include "session/gnuplot.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr double kLogFrom = 8;  // the axis is logarithmic from this ratio to the best time on

__attribute__((format(printf, 2, 3))) void append(std::string* text, const char* pattern, ...) {
  va_list arguments, again;
  va_start(arguments, pattern);
  va_copy(again, arguments);
  int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  std::vector<char> added(length > 0 ? static_cast<std::size_t>(length) + 1 : 1);
  std::vsnprintf(added.data(), added.size(), pattern, again);
  va_end(arguments);
  va_end(again);
  *text += added.data();
}

void write_point(std::string* f, const char* series, const SplitPoint& p, std::uint32_t pixel_count) {
  if (p.ns_per_pixel <= 0) return;
  append(f, "%s,%.5f,%.2f,%.4f,%.0f\n", series, p.m, p.ns_per_pixel, p.ns_per_pixel * pixel_count * 1e-6, p.bytes);
}

void write_data(std::string* f, const SplitFigures& s, std::uint32_t pixel_count) {
  auto ms = [&](const SplitPoint& p) { return p.ns_per_pixel * pixel_count * 1e-6; };
  append(f, "$sweep << EOD\n");
  for (const SplitPoint& p : s.sweep) append(f, "%.5f %.6g\n", p.m, ms(p));
  append(f, "EOD\n$chosen << EOD\n%.5f %.6g\nEOD\n$best << EOD\n%.5f %.6g\nEOD\n", s.chosen.m, ms(s.chosen), s.best.m,
         ms(s.best));
  if (s.both.ns_per_pixel > 0)
    append(f, "$effect << EOD\n%.5f %.6g\nEOD\n$both << EOD\n%.5f %.6g\nEOD\n", s.effect.m, ms(s.effect), s.both.m,
           ms(s.both));
  append(f, "$paper << EOD\n");
  for (const PaperRow& row : s.paper)
    append(f, "\"%s\\n%d processors\" %.1f %.1f %.1f\n", row.scene, row.processors, row.ns_per_pixel, row.our_ns,
           row.bound_ns);
  append(f, "EOD\n");
}

void write_sweep_plot(std::string* f, const SplitFigures& s, std::uint32_t pixel_count) {
  double local_ms = s.local.ns_per_pixel * pixel_count * 1e-6, chosen_ms = s.chosen.ns_per_pixel * pixel_count * 1e-6;
  bool logarithmic = s.local.ns_per_pixel > kLogFrom * s.best.ns_per_pixel;
  append(f, "set title \"Frame time over the device's share\"\n");
  append(f, "set xlabel \"m: the device's share of the rows\"\nset xrange [-0.02:1.02]\n");
  append(f, "set ylabel 'milliseconds per frame%s'\nset grid lc rgb '#dddddd'\n", logarithmic ? ", logarithmic" : "");
  if (logarithmic)
    append(f, "set logscale y\nset yrange [%.6g:%.6g]\n", 0.5 * s.best.ns_per_pixel * pixel_count * 1e-6, 2 * local_ms);
  else
    append(f, "set yrange [0:%.6g]\n", 1.15 * local_ms);
  append(f, "set key bottom right box lc rgb '#cccccc' opaque width 1 height 0.5 samplen 2\n");
  append(f,
         "plot %.6g title 'device alone: %.4g ms' with lines dt 2 lw 1.5 lc rgb '#888888', \\\n"
         "  $sweep using 1:2 title 'm fixed' with linespoints pt 7 ps 0.8 lw 2 lc rgb '#1f6fb4', \\\n"
         "  $best using 1:2 title 'best fixed m = %.3f: %.4g ms' with points pt 6 ps 2.2 lw 2 lc rgb '#1f6fb4', "
         "\\\n"
         "  $chosen using 1:2 title 'chosen m = %.3f: %.4g ms' with points pt 2 ps 1.8 lw 3 lc rgb '#d62728'",
         local_ms, local_ms, s.best.m, s.best.ns_per_pixel * pixel_count * 1e-6, s.chosen.m, chosen_ms);
  if (s.both.ns_per_pixel > 0)
    append(f,
           ", \\\n  $effect using 1:2 title 'by effect: %.4g ms' with points pt 9 ps 1.8 lc rgb '#2ca02c', \\\n"
           "  $both using 1:2 title 'rows and effect, m = %.3f: %.4g ms' with points pt 1 ps 1.8 lw 3 lc rgb '#2ca02c'",
           s.effect.ns_per_pixel * pixel_count * 1e-6, s.both.m, s.both.ns_per_pixel * pixel_count * 1e-6);
  append(f, "\n");
}

void write_paper_plot(std::string* f) {
  append(f,
         "set title 'At the times of Aranha et al. 2007, Table 1'\nunset logscale\nset xrange [-0.6:5.6]\n"
         "set yrange [0:1500]\nset xlabel 'scene and processors of the server, T_t = 400 ns' offset 0,-0.6\nset "
         "ylabel 'nanoseconds per "
         "pixel'\n"
         "set key top right nobox\nset style data histograms\nset style histogram clustered gap 1\n"
         "set style fill solid 0.9 noborder\nset boxwidth 0.9\nset xtics scale 0 font ',9'\n"
         "plot $paper using 2:xtic(1) title 'the paper: render, then send' lc rgb '#bbbbbb', \\\n"
         "  '' using 3 title 'pocketray: both overlapped' lc rgb '#d62728', \\\n"
         "  '' using 0:4 title 'bound for full overlap' with points pt 9 ps 1.6 lc rgb 'black'\n");
}

}  // namespace

Status write_split_csv(const std::string& folder, const SplitFigures& figures, std::uint32_t pixel_count) {
  std::string text = "series,m,ns_per_pixel,ms_per_frame,bytes_per_frame\n";
  for (const SplitPoint& point : figures.sweep) write_point(&text, "sweep", point, pixel_count);
  write_point(&text, "chosen", figures.chosen, pixel_count);
  write_point(&text, "best", figures.best, pixel_count);
  write_point(&text, "local", figures.local, pixel_count);
  write_point(&text, "effect", figures.effect, pixel_count);
  write_point(&text, "rows and effect", figures.both, pixel_count);
  return write_file(folder + "/split.csv", text);
}

Status draw_split(const std::string& folder, const SplitPlot& plot, const SplitFigures& figures, bool* drawn) {
  *drawn = false;
  std::string text;
  bool paper = !figures.paper.empty();
  append(&text, "set terminal pngcairo size %d,620 font 'sans,11' noenhanced\nset output 'split.png'\n",
         paper ? 1500 : 860);
  write_data(&text, figures, plot.pixel_count);
  append(&text, "set multiplot layout 1,%d title %s font 'sans,13'\n", paper ? 2 : 1,
         gnuplot_lines(plot.title, paper ? 180 : 100).c_str());
  write_sweep_plot(&text, figures, plot.pixel_count);
  if (paper) write_paper_plot(&text);
  append(&text, "unset multiplot\n");
  RETURN_IF_ERROR(write_file(folder + "/split.gnuplot", text));
  *drawn = run_gnuplot(folder, {"split.gnuplot"});
  return success();
}

}  // namespace pocketray
