#include "desktop/coherence_report/image_space_report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "desktop/accuracy/csv.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/accuracy/plot_axis.h"
#include "desktop/accuracy/text.h"

namespace pocketray {
namespace {

double pixels_of(const ImageSpaceRun& run) {
  return static_cast<double>(run.width) * run.height * static_cast<double>(run.frame_count);
}

ErrorRow row_of(const ImageSpaceRun& run, const ImageSpaceFigures& f) {
  const double pixels = pixels_of(run);
  const ImageSpaceErrors& e = f.errors;
  ErrorRow row;
  row.name = name_of(f.way);
  row.pixels = static_cast<double>(f.traced) / pixels;
  row.rays = ratio_of(static_cast<double>(f.cost.rays), static_cast<double>(run.whole.rays));
  row.time = ratio_of(f.cost.ms, run.whole.ms);
  row.wrong = static_cast<double>(e.wrong) / pixels, row.wrong_shown = static_cast<double>(e.wrong_shown) / pixels;
  row.wrong_most = static_cast<double>(e.wrong_most) * static_cast<double>(run.frame_count) / pixels;
  row.flip = e.flip_sum / static_cast<double>(run.frame_count), row.flip_max = e.flip_max;
  return row;
}

ErrorRow our_row(const SequenceRun& run) {
  const FrameFigures all = entire(run);
  ErrorRow row;
  row.name = "pocketray";
  row.pixels = static_cast<double>(all.retraced) /
               (static_cast<double>(run.width) * run.height * static_cast<double>(run.frames.size()));
  row.rays = ratio_of(static_cast<double>(all.coherent.rays), static_cast<double>(all.whole.rays));
  row.time = ratio_of(all.coherent.ms, all.whole.ms);
  return row;
}

struct Columns {
  const char *heading, *key;
  double ErrorRow::*value;
};
constexpr Columns kColumns[] = {{"pixels", "pixels", &ErrorRow::pixels},
                                {"rays", "rays", &ErrorRow::rays},
                                {"time", "time", &ErrorRow::time},
                                {"wrong pixels", "wrong", &ErrorRow::wrong},
                                {"as shown", "wrong_shown", &ErrorRow::wrong_shown},
                                {"in a frame, at most", "wrong_most", &ErrorRow::wrong_most},
                                {"ꟻLIP, mean", "flip", &ErrorRow::flip},
                                {"ꟻLIP, at most", "flip_max", &ErrorRow::flip_max}};

struct ErrorSeries {
  std::string title;
  std::vector<ErrorRow> rows;
};

// Ours, then the variants of each method.
std::vector<ErrorSeries> series_of(const CoherenceReport& report) {
  const std::vector<ErrorRow> rows = error_rows(report);
  std::vector<ErrorSeries> all = {
      {"Badt 1988: share sampled", {}}, {"Chapman 1990: frames apart", {}}, {"pocketray: no error", {rows[0]}}};
  for (std::size_t i = 1; i < rows.size(); ++i)
    all[report.image_space.ways[i - 1].way.method == ImageSpaceMethod::badt ? 0 : 1].rows.push_back(rows[i]);
  return all;
}

std::string label_of(const ImageSpaceWay& way) {
  return way.method == ImageSpaceMethod::badt ? format("1/%u", way.parameter) : std::to_string(way.parameter);
}

const char* color_of(ImageSpaceMethod method) { return kPlotColors[method == ImageSpaceMethod::badt ? 1 : 2]; }

// Labels for the variants beside their points.
std::string label_commands(const CoherenceReport& report, const Axis& x, const Axis& y, double ErrorRow::*work,
                           double ErrorRow::*error) {
  const std::vector<ErrorRow> rows = error_rows(report);
  std::vector<PlotPoint> points;
  std::vector<std::string> texts;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    points.push_back({place_on(x, rows[i].*work), place_on(y, rows[i].*error)});
    texts.push_back(label_of(report.image_space.ways[i - 1].way));
  }
  points.push_back({place_on(x, rows[0].*work), place_on(y, 0)});
  for (std::size_t i = 1; i < texts.size(); ++i)  // the lines between them
    if (report.image_space.ways[i].way.method == report.image_space.ways[i - 1].way.method)
      for (double t : {0.25, 0.5, 0.75})
        points.push_back({points[i - 1].x + t * (points[i].x - points[i - 1].x),
                          points[i - 1].y + t * (points[i].y - points[i - 1].y)});
  std::string commands;
  const std::vector<Label> labels = place_labels({50, 18}, points, texts);
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i].placed)
      commands += "set label " + gnuplot_string(texts[i]) +
                  format(" at graph %.4f,%.4f %s tc rgb '%s'\n", labels[i].at.x, labels[i].at.y,
                         labels[i].align < 0   ? "left"
                         : labels[i].align > 0 ? "right"
                                               : "center",
                         color_of(report.image_space.ways[i].way.method));
  return commands;
}

Plot error_plot(const CoherenceReport& report, const std::string& name, const std::string& title,
                double ErrorRow::*work, const std::string& work_label, double ErrorRow::*error,
                const std::string& error_label) {
  std::vector<double> work_values, error_values = {0};
  for (const ErrorRow& row : error_rows(report)) {
    work_values.push_back(row.*work);
    error_values.push_back(row.*error);
  }
  const Axis x = axis_of(work_values, 0, true), y = axis_of(error_values, 0, true);
  constexpr int kHeight = 550;
  const PlotFrame frame = {0.205, 0.97, 154.0 / kHeight, 1 - 48.0 / kHeight, kHeight};
  std::string data, plots;
  const std::vector<ErrorSeries> all = series_of(report);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::string lines;
    for (const ErrorRow& row : all[i].rows)
      lines += format("%.8g %.8g\n", drawn_value(x, row.*work), drawn_value(y, row.*error));
    const std::string block = "series" + std::to_string(i);
    data += data_block(block, lines);
    plots += (i ? ", \\\n  $" : "$") + block + " using 1:2 title " + gnuplot_string(all[i].title) +
             format(" with linespoints lw 2 pt %d ps %.1f lc rgb '%s'", i == 2 ? 9 : 7, i == 2 ? 1.4 : 0.9,
                    kPlotColors[i == 2 ? 0 : i + 1]);
  }
  auto label = [](const std::string& text, const Axis& axis) {
    return gnuplot_string(text + (axis.logarithmic ? ", logarithmic" : ""));
  };
  const std::string body = frame_commands(frame) + axis_commands(x, 'x') + axis_commands(y, 'y') +
                           label_commands(report, x, y, work, error) + "set title " + gnuplot_string(title) +
                           "\nset xlabel " + label(work_label, x) + "\nset ylabel " + label(error_label, y) +
                           " offset 0.6,0\nset key at screen 0.5, screen 0.01 center bottom vertical samplen 2\nplot " +
                           plots + "\n";
  return {name, script_of(name, kHeight, data, body)};
}

}  // namespace

std::vector<ErrorRow> error_rows(const CoherenceReport& report) {
  CHECK(report.image_space.frame_count > 0);
  std::vector<ErrorRow> rows = {our_row(report.ours)};
  for (const ImageSpaceFigures& f : report.image_space.ways) rows.push_back(row_of(report.image_space, f));
  return rows;
}

void print_image_space(const CoherenceReport& report) {
  const ImageSpaceRun& run = report.image_space;
  if (run.frame_count == 0) return;
  std::printf("image-space methods, %zu frames; wrong pixels differ from the whole frame in some bit\n",
              run.frame_count);
  std::printf("  %-40s %8s %8s %8s %10s %10s %10s %10s %8s\n", "", "pixels", "rays", "time", "wrong", "as shown",
              "most", "FLIP", "most");
  for (const ErrorRow& row : error_rows(report))
    std::printf("  %-40s %8.4f %8.4f %8.4f %10.6f %10.6f %10.6f %10.7f %8.4f\n", row.name.c_str(), row.pixels, row.rays,
                row.time, row.wrong, row.wrong_shown, row.wrong_most, row.flip, row.flip_max);
}

Json image_space_json(const CoherenceReport& report) {
  const ImageSpaceRun& run = report.image_space;
  if (run.frame_count == 0) return Json();
  const std::vector<ErrorRow> rows = error_rows(report);
  Json ways = Json::array();
  for (std::size_t i = 0; i < run.ways.size(); ++i) {
    const ImageSpaceFigures& f = run.ways[i];
    Json way = {{"method", f.way.method == ImageSpaceMethod::badt ? "Badt 1988" : "Chapman 1990"},
                {f.way.method == ImageSpaceMethod::badt ? "sampled_one_of" : "frames_apart", f.way.parameter},
                {"ms", f.cost.ms},
                {"cpu_ms", f.cost.cpu_ms}};
    for (const Columns& column : kColumns) way[column.key] = rows[i + 1].*column.value;
    ways.push_back(way);
  }
  return {{"frames", run.frame_count}, {"whole_ms", run.whole.ms}, {"whole_rays", run.whole.rays}, {"ways", ways}};
}

std::string image_space_csv(const CoherenceReport& report) {
  std::string csv = "way";
  for (const Columns& column : kColumns) csv += std::string(",") + column.key;
  csv += '\n';
  for (const ErrorRow& row : error_rows(report)) {
    csv += csv_field(row.name);
    for (const Columns& column : kColumns) csv += format(",%.6g", row.*column.value);
    csv += '\n';
  }
  return csv;
}

std::string image_space_table(const CoherenceReport& report) {
  std::string text = "<div class=\"box\"><table><thead><tr><th></th>";
  for (const Columns& column : kColumns) text += std::string("<th>") + column.heading + "</th>";
  text += "</tr></thead>\n<tbody>\n";
  for (const ErrorRow& row : error_rows(report)) {
    text += "<tr><th>" + escaped(row.name) + "</th>";
    for (const Columns& column : kColumns) text += "<td>" + figure(row.*column.value, 3) + "</td>";
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

Plot wrong_plot(const CoherenceReport& report) {
  return error_plot(report, "wrong", "Wrong pixels against pixels traced", &ErrorRow::pixels,
                    "pixels traced, ratio to whole frames", &ErrorRow::wrong, "share of wrong pixels");
}

Plot flip_plot(const CoherenceReport& report) {
  return error_plot(report, "flip", "Visible error against time", &ErrorRow::time, "time, ratio to whole frames",
                    &ErrorRow::flip, "mean ꟻLIP");
}

}  // namespace pocketray
