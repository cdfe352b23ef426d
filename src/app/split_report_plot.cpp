#include "app/split_report_plot.h"

#include <cstdio>
#include <memory>

#include "accuracy/gnuplot.h"
#include "app/gnuplot.h"

namespace pocketray {
namespace {

constexpr double kLogFrom = 8;  // times the best, from which on times are drawn by their logarithm

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Status open_file(const std::string& path, File* file) {
  file->reset(std::fopen(path.c_str(), "w"));
  return *file ? success() : failure("%.300s cannot be written: does its folder exist?", path.c_str());
}

Status finish_file(const std::string& path, File* file) {
  bool failed = std::ferror(file->get()) != 0;
  failed = std::fclose(file->release()) != 0 || failed;
  return failed ? failure("%.300s cannot be written: is there space left?", path.c_str()) : success();
}

void write_point(std::FILE* f, const char* series, const SplitPoint& p, std::uint32_t pixel_count) {
  if (p.ns_per_pixel <= 0) return;
  std::fprintf(f, "%s,%.5f,%.2f,%.4f,%.0f\n", series, p.m, p.ns_per_pixel, p.ns_per_pixel * pixel_count * 1e-6,
               p.bytes);
}

void write_data(std::FILE* f, const SplitFigures& s, std::uint32_t pixel_count) {
  auto ms = [&](const SplitPoint& p) { return p.ns_per_pixel * pixel_count * 1e-6; };
  std::fprintf(f, "$sweep << EOD\n");
  for (const SplitPoint& p : s.sweep) std::fprintf(f, "%.5f %.6g\n", p.m, ms(p));
  std::fprintf(f, "EOD\n$chosen << EOD\n%.5f %.6g\nEOD\n$best << EOD\n%.5f %.6g\nEOD\n", s.chosen.m, ms(s.chosen),
               s.best.m, ms(s.best));
  std::fprintf(f, "$paper << EOD\n");
  for (const PaperRow& row : s.paper)
    std::fprintf(f, "\"%s\\n%d processors\" %.1f %.1f %.1f\n", row.scene, row.processors, row.ns_per_pixel, row.our_ns,
                 row.bound_ns);
  std::fprintf(f, "EOD\n");
}

void write_sweep_plot(std::FILE* f, const SplitFigures& s, std::uint32_t pixel_count) {
  double local_ms = s.local.ns_per_pixel * pixel_count * 1e-6, chosen_ms = s.chosen.ns_per_pixel * pixel_count * 1e-6;
  bool logarithmic = s.local.ns_per_pixel > kLogFrom * s.best.ns_per_pixel;
  std::fprintf(f, "set title 'Time of a frame over the share of the device'\n");
  std::fprintf(f, "set xlabel 'm: share of the rows that the device renders'\nset xrange [-0.02:1.02]\n");
  std::fprintf(f, "set ylabel 'milliseconds per frame%s'\nset grid lc rgb '#dddddd'\n",
               logarithmic ? ", logarithmic" : "");
  if (logarithmic)
    std::fprintf(f, "set logscale y\nset yrange [%.6g:%.6g]\n", 0.5 * s.best.ns_per_pixel * pixel_count * 1e-6,
                 2 * local_ms);
  else
    std::fprintf(f, "set yrange [0:%.6g]\n", 1.15 * local_ms);
  std::fprintf(f, "set key bottom right box lc rgb '#cccccc' opaque width 1 height 0.5 samplen 2\n");
  std::fprintf(f,
               "plot %.6g title 'device alone: %.4g ms' with lines dt 2 lw 1.5 lc rgb '#888888', \\\n"
               "  $sweep using 1:2 title 'm fixed' with linespoints pt 7 ps 0.8 lw 2 lc rgb '#1f6fb4', \\\n"
               "  $best using 1:2 title 'best fixed m = %.3f: %.4g ms' with points pt 6 ps 2.2 lw 2 lc rgb '#1f6fb4', "
               "\\\n"
               "  $chosen using 1:2 title 'chosen m = %.3f: %.4g ms' with points pt 2 ps 1.8 lw 3 lc rgb '#d62728'\n",
               local_ms, local_ms, s.best.m, s.best.ns_per_pixel * pixel_count * 1e-6, s.chosen.m, chosen_ms);
}

void write_paper_plot(std::FILE* f) {
  std::fprintf(f,
               "set title 'At the times of Aranha et al. 2007, Table 1'\nunset logscale\nset xrange [-0.6:5.6]\n"
               "set yrange [0:1500]\nset xlabel 'scene and processors of the server, T_t = 400 ns' offset 0,-0.6\nset "
               "ylabel 'nanoseconds per "
               "pixel'\n"
               "set key top right nobox\nset style data histograms\nset style histogram clustered gap 1\n"
               "set style fill solid 0.9 noborder\nset boxwidth 0.9\nset xtics scale 0 font ',9'\n"
               "plot $paper using 2:xtic(1) title 'the paper: render, then send' lc rgb '#bbbbbb', \\\n"
               "  '' using 3 title 'pocketray: both at once' lc rgb '#d62728', \\\n"
               "  '' using 0:4 title 'full overlap allows' with points pt 9 ps 1.6 lc rgb 'black'\n");
}

}  // namespace

Status write_split_csv(const std::string& folder, const SplitFigures& figures, std::uint32_t pixel_count) {
  std::string path = folder + "/split.csv";
  File file(nullptr, std::fclose);
  RETURN_IF_ERROR(open_file(path, &file));
  std::fprintf(file.get(), "series,m,ns_per_pixel,ms_per_frame,bytes_per_frame\n");
  for (const SplitPoint& point : figures.sweep) write_point(file.get(), "sweep", point, pixel_count);
  write_point(file.get(), "chosen", figures.chosen, pixel_count);
  write_point(file.get(), "best", figures.best, pixel_count);
  write_point(file.get(), "local", figures.local, pixel_count);
  return finish_file(path, &file);
}

Status draw_split(const std::string& folder, const SplitPlot& plot, const SplitFigures& figures, bool* drawn) {
  *drawn = false;
  std::string path = folder + "/split.gnuplot";
  File file(nullptr, std::fclose);
  RETURN_IF_ERROR(open_file(path, &file));
  std::FILE* f = file.get();
  bool paper = !figures.paper.empty();
  std::fprintf(f, "set terminal pngcairo size %d,620 font 'sans,11' noenhanced\nset output 'split.png'\n",
               paper ? 1500 : 860);
  write_data(f, figures, plot.pixel_count);
  std::fprintf(f, "set multiplot layout 1,%d title %s font 'sans,13'\n", paper ? 2 : 1,
               gnuplot_string(plot.title).c_str());
  write_sweep_plot(f, figures, plot.pixel_count);
  if (paper) write_paper_plot(f);
  std::fprintf(f, "unset multiplot\n");
  RETURN_IF_ERROR(finish_file(path, &file));
  *drawn = run_gnuplot(folder, {"split.gnuplot"});
  return success();
}

}  // namespace pocketray
