#include "desktop/coherence_report/table_sweep.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/plot_axis.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

double rays_of(const TableSide& s) {
  return ratio_of(static_cast<double>(s.all.coherent.rays), static_cast<double>(s.all.whole.rays));
}
double time_of(const TableSide& s) { return ratio_of(s.all.coherent.ms, s.all.whole.ms); }
// CPU time of all threads; less noisy on a busy machine.
double cpu_of(const TableSide& s) { return ratio_of(s.all.coherent.cpu_ms, s.all.whole.cpu_ms); }
double retraced_of(const TableSide& s) {
  return ratio_of(static_cast<double>(s.all.retraced), static_cast<double>(s.pixels));
}
double changed_of(const TableSide& s) {
  return ratio_of(static_cast<double>(s.all.changed), static_cast<double>(s.pixels));
}

// "512K", "2M", as --memory takes them.
std::string short_bytes(std::size_t bytes) {
  return bytes < 1u << 20 ? format("%zuK", bytes >> 10) : format("%zuM", bytes >> 20);
}

}  // namespace

TableSide table_side(std::uint32_t side, const SequenceRun& run) {
  CHECK_GT(side, 0u);
  CHECK_LE(run.table_bytes, run.coherence_bytes);
  return {side, run.table_bytes, run.coherence_bytes, std::uint64_t(run.width) * run.height * run.frames.size(),
          entire(run)};
}

std::string table_sweep_text(const TableSweep& sweep) {
  return sweep.papers_way ? "tables hold all rays, as in the paper: no rays of the scene need tables"
                          : "tables hold the rays behind mirrors, glass and blended surfaces";
}

void print_table_sweep(const TableSweep& sweep) {
  if (sweep.sides.empty()) return;
  std::printf("side of the tables; every frame is equal in every bit; %s\n", table_sweep_text(sweep).c_str());
  std::printf("  %-8s %15s %8s %8s %8s %12s %8s %8s\n", "blocks", "bytes", "pixels", "changed", "rays", "ms", "time",
              "CPU");
  for (const TableSide& s : sweep.sides)
    std::printf("  %-8s %15s %8.4f %8.4f %8.4f %12.2f %8.4f %8.4f\n", format("%ux%u", s.side, s.side).c_str(),
                grouped(s.table_bytes).c_str(), retraced_of(s), changed_of(s), rays_of(s), s.all.coherent.ms,
                time_of(s), cpu_of(s));
}

Json table_sweep_json(const TableSweep& sweep) {
  if (sweep.sides.empty()) return Json();
  Json sides = Json::array();
  for (const TableSide& s : sweep.sides)
    sides.push_back({{"side", s.side},
                     {"table_bytes", s.table_bytes},
                     {"coherence_bytes", s.coherence_bytes},
                     {"retraced", retraced_of(s)},
                     {"changed", changed_of(s)},
                     {"rays", rays_of(s)},
                     {"ms", s.all.coherent.ms},
                     {"time", time_of(s)},
                     {"cpu_time", cpu_of(s)}});
  return {{"papers_way", sweep.papers_way}, {"sides", sides}};
}

std::string table_sweep_csv(const TableSweep& sweep) {
  std::string csv = "side,table_bytes,coherence_bytes,retraced,changed,rays,ms,time,cpu_time\n";
  for (const TableSide& s : sweep.sides)
    csv += format("%u,%zu,%zu,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n", s.side, s.table_bytes, s.coherence_bytes,
                  retraced_of(s), changed_of(s), rays_of(s), s.all.coherent.ms, time_of(s), cpu_of(s));
  return csv;
}

std::string table_sweep_markup(const TableSweep& sweep) {
  std::string text =
      "<div class=\"box\"><table><thead><tr><th>blocks</th><th>bytes</th><th>pixels</th><th>changed</th><th>rays</th>"
      "<th>ms</th><th>time</th><th>CPU time</th></tr></thead>\n<tbody>\n";
  for (const TableSide& s : sweep.sides) {
    text += format("<tr><th>%u × %u</th><td>", s.side, s.side) + grouped(s.table_bytes) + "</td>";
    for (double value : {retraced_of(s), changed_of(s), rays_of(s)}) text += format("<td>%.4f</td>", value);
    text += format("<td>%.2f</td><td>%.4f</td><td>%.4f</td></tr>\n", s.all.coherent.ms, time_of(s), cpu_of(s));
  }
  return text + "</tbody></table></div>\n";
}

Plot table_plot(const TableSweep& sweep) {
  CHECK(!sweep.sides.empty());
  constexpr struct {
    const char* title;
    double (*value)(const TableSide&);
    int color;
  } kSeries[] = {{"CPU time", cpu_of, 1}, {"rays", rays_of, 2}, {"pixels traced", retraced_of, 0}};
  std::vector<double> values, sides;
  for (const TableSide& s : sweep.sides) {
    sides.push_back(s.side);
    for (const auto& series : kSeries) values.push_back(series.value(s));
  }
  const Axis x = axis_of(sides, 0, true), y = axis_of(values, 0, true);
  constexpr int kHeight = 572;
  std::string data, plots, tics;
  for (const auto& series : kSeries) {
    std::string lines;
    for (const TableSide& s : sweep.sides) lines += format("%u %.8g\n", s.side, series.value(s));
    const std::string block = "series" + std::to_string(series.color);
    data += data_block(block, lines);
    plots += (plots.empty() ? "$" : ", \\\n  $") + block + " using 1:2 title " + gnuplot_string(series.title) +
             format(" with linespoints lw 2 pt 7 ps 0.9 lc rgb '%s'", kPlotColors[series.color]);
  }
  for (const TableSide& s : sweep.sides)
    tics += format("%s\"%u\\n%s\" %u", tics.empty() ? "" : ", ", s.side, short_bytes(s.table_bytes).c_str(), s.side);
  const std::string body =
      frame_commands({0.165, 0.97, 176.0 / kHeight, 1 - 48.0 / kHeight, kHeight}) + axis_commands(x, 'x') +
      "set xtics (" + tics + ")\n" + axis_commands(y, 'y') +
      "set title 'Side of the tables of rays'\nset xlabel 'blocks of pixels along each side; bytes of the tables' "
      "offset 0,-0.9\nset "
      "ylabel "
      "'ratio to whole frames" +
      (y.logarithmic ? ", logarithmic" : "") +
      "' offset 0.6,0\nset key at screen 0.5, screen 0.01 center bottom vertical samplen 2\nplot " + plots + "\n";
  return {"tables", script_of("tables", kHeight, data, body)};
}

}  // namespace pocketray
