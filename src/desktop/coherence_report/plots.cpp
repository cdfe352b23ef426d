#include "desktop/coherence_report/plots.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/plot_axis.h"
#include "desktop/accuracy/text.h"
#include "session/measure.h"

namespace pocketray {
namespace {

struct RatioSeries {
  std::string title, style;
  std::vector<PlotPoint> points;  // frame, ratio
};

template <class Ratio>
RatioSeries series_of(const SequenceRun& run, const std::string& title, const std::string& style, Ratio ratio) {
  RatioSeries series = {title, style, {}};
  for (const FrameFigures& f : run.frames) {
    double value = ratio(f);
    if (std::isfinite(value)) series.points.push_back({static_cast<double>(f.frame), value});
  }
  return series;
}

RatioSeries paper_series(const SequenceRun& run, double PaperRatio::*ratio) {
  RatioSeries series = {"Jevans 1992, Table 2", "points pt 7 ps 1.1 lc rgb 'black'", {}};
  for (const TableRow& row : table_rows(run, true))
    if (row.paper && row.name != "entire")
      series.points.push_back({static_cast<double>(row.figures.frame), row.paper->*ratio});
  return series;
}

std::string line_style(int color, double width) {
  return format("lines lw %.1f lc rgb '%s'", width, kPlotColors[color]);
}

// Adds every point as a dot and, as a line, medians of a few neighbours: times vary.
void add_smoothed(const RatioSeries& series, int color, std::vector<RatioSeries>* all) {
  constexpr std::size_t kReach = 4;  // neighbours on each side
  const std::size_t count = series.points.size();
  if (count == 0) return;
  RatioSeries line = {
      format("%s, median of %zu frames", series.title.c_str(), 2 * kReach + 1), line_style(color, 2), {}};
  for (std::size_t i = 0; i < count; ++i) {
    double values[2 * kReach + 1];
    std::uint32_t used = 0;
    for (std::size_t k = i < kReach ? 0 : i - kReach; k < std::min(count, i + kReach + 1); ++k)
      values[used++] = series.points[k].y;
    line.points.push_back({series.points[i].x, range_of(values, used).median});
  }
  line.points[0] = series.points[0];  // traced whole
  all->push_back({"", format("points pt 7 ps 0.25 lc rgb '%s'", kPlotColors[color]), series.points});
  all->push_back(line);
}

Plot ratio_plot(const std::string& name, const std::string& title, const SequenceRun& run,
                const std::vector<RatioSeries>& all) {
  CHECK(!run.frames.empty());
  std::vector<double> values = {1};
  int shown = 0;  // in the key
  for (const RatioSeries& series : all) {
    shown += !series.points.empty() && !series.title.empty();
    for (const PlotPoint& point : series.points) values.push_back(point.y);
  }
  Axis y = axis_of(values, 0, true);
  const int height = 484 + 22 * shown;
  PlotFrame frame = {0.165, 0.97, (88.0 + 22 * shown) / height, 1 - 48.0 / height, height};
  std::string data, plots = "1 notitle with lines dt 2 lw 1.2 lc rgb '#888888'";
  for (const RatioSeries& series : all) {
    if (series.points.empty()) continue;
    std::string block = "series" + std::to_string(&series - all.data()), lines;
    for (const PlotPoint& point : series.points) lines += format("%.0f %.8g\n", point.x, drawn_value(y, point.y));
    data += data_block(block, lines);
    plots += ", \\\n  $" + block + " using 1:2 " +
             (series.title.empty() ? "notitle" : "title " + gnuplot_string(series.title)) + " with " + series.style;
  }
  const std::uint32_t first = run.frames.front().frame, last = run.frames.back().frame;
  const double margin = 0.02 * (last - first) + 0.5;
  std::string body = frame_commands(frame) + format("set xrange [%.6g:%.6g]\n", first - margin, last + margin) +
                     axis_commands(y, 'y') + "set title " + gnuplot_string(title) +
                     "\nset xlabel 'frame'\nset ylabel 'ratio to whole frames" +
                     (y.logarithmic ? ", logarithmic" : "") +
                     "' offset 0.6,0\nset key at screen 0.5, screen 0.01 center bottom vertical samplen 2\n"
                     "plot " +
                     plots + "\n";
  return {name, script_of(name, height, data, body)};
}

}  // namespace

Plot rays_plot(const CoherenceReport& report) {
  const double pixels = static_cast<double>(report.ours.width) * report.ours.height;
  auto retraced = [&](const FrameFigures& f) { return static_cast<double>(f.retraced) / pixels; };
  auto changed = [&](const FrameFigures& f) { return static_cast<double>(f.changed) / pixels; };
  auto rays = [](const FrameFigures& f) {
    return ratio_of(static_cast<double>(f.coherent.rays), static_cast<double>(f.whole.rays));
  };
  std::vector<RatioSeries> all = {series_of(report.papers_way, "the paper's way: pixels", line_style(1, 1.5), retraced),
                                  series_of(report.ours, "pixels that changed",
                                            "filledcurves y=1e-9 fc rgb '#bbbbbb' fs solid 0.6 noborder", changed),
                                  series_of(report.ours, "pixels retraced", line_style(0, 2), retraced),
                                  series_of(report.ours, "rays", line_style(2, 1.5), rays)};
  if (report.is_papers_scene) all.push_back(paper_series(report.ours, &PaperRatio::rays));
  return ratio_plot("rays", "Rays and pixels traced", report.ours, all);
}

Plot time_plot(const CoherenceReport& report) {
  auto time = [](const FrameFigures& f) { return ratio_of(f.coherent.ms, f.whole.ms); };
  std::vector<RatioSeries> all;
  add_smoothed(series_of(report.papers_way, "the paper's way", "", time), 1, &all);
  add_smoothed(series_of(report.ours, "pocketray", "", time), 0, &all);
  if (report.is_papers_scene) all.push_back(paper_series(report.ours, &PaperRatio::time));
  return ratio_plot("time", "Time of each frame", report.ours, all);
}

}  // namespace pocketray
