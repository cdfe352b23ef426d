#include "desktop/coherence_report/report.h"

#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "desktop/accuracy/csv.h"
#include "desktop/accuracy/text.h"
#include "desktop/coherence_report/image_space_report.h"

namespace pocketray {
namespace {

double of(std::uint64_t part, std::uint64_t whole) {
  return ratio_of(static_cast<double>(part), static_cast<double>(whole));
}
double time_ratio(const FrameFigures& f) { return ratio_of(f.coherent.ms, f.whole.ms); }

std::uint64_t pixel_count(const SequenceRun& run, std::size_t frames) {
  return std::uint64_t(run.width) * run.height * frames;
}

std::string paper_figure(const PaperRatio* paper, double PaperRatio::*ratio) {
  return paper ? format("%.4f", paper->*ratio) : "";
}

void print_table(const SequenceRun& run, bool is_papers_scene) {
  const char* heading = is_papers_scene ? "paper" : "";
  std::printf("  %-8s %15s %15s %8s %8s %8s %12s %12s %8s %8s\n", "frame", "rays, whole", "coherent", "ratio", "pixels",
              heading, "ms, whole", "coherent", "ratio", heading);
  for (const TableRow& row : table_rows(run, is_papers_scene)) {
    const FrameFigures& f = row.figures;
    std::printf("  %-8s %15s %15s %8.4f %8.4f %8s %12.2f %12.2f %8.4f %8s\n", row.name.c_str(),
                grouped(f.whole.rays).c_str(), grouped(f.coherent.rays).c_str(), of(f.coherent.rays, f.whole.rays),
                of(f.retraced, row.pixels), paper_figure(row.paper, &PaperRatio::rays).c_str(), f.whole.ms,
                f.coherent.ms, time_ratio(f), paper_figure(row.paper, &PaperRatio::time).c_str());
  }
}

void print_changes(const SequenceRun& run) {
  const std::size_t frames = run.frames.size() - 1;
  const FrameFigures f = sum_of(run, 1, run.frames.size());
  const std::uint64_t pixels = pixel_count(run, frames);
  if (frames > 0) {
    std::printf("  after the first frame, of %s pixels\n", grouped(pixels).c_str());
    std::printf("    %-34s %14s  %.4f\n", "changed, in any bit of radiance", grouped(f.changed).c_str(),
                of(f.changed, pixels));
    std::printf("    %-34s %14s  %.4f\n", "changed as shown, in 8 bits", grouped(f.shown).c_str(), of(f.shown, pixels));
    std::printf("    %-34s %14s  %.4f", "retraced", grouped(f.retraced).c_str(), of(f.retraced, pixels));
    if (f.changed > 0) std::printf(": %.3f times those that changed", of(f.retraced, f.changed));
    std::printf("\n");
  }
  if (f.moving_rays > 0)
    std::printf("  finding them: %s rays against the moving geometry alone, not counted above\n",
                grouped(f.moving_rays).c_str());
}

void print_way(const SequenceRun& run, bool is_papers_scene) {
  if (run.frames.empty()) return;
  print_table(run, is_papers_scene);
  const FrameFigures all = entire(run);
  std::printf("  CPU time of all threads: %.0f ms and %.0f ms, ratio %.4f\n", all.whole.cpu_ms, all.coherent.cpu_ms,
              ratio_of(all.coherent.cpu_ms, all.whole.cpu_ms));
  const CoherentSteps& s = all.steps;
  std::printf(
      "  coherent frames, ms: pose %.0f, refit %.0f, follow what moves %.0f, find what changed %.0f, keep %.0f; the "
      "rest is tracing\n",
      s.pose_ms, s.refit_ms, s.follow_ms, s.find_ms, s.keep_ms);
  print_changes(run);
  std::printf("  memory of coherence: %s bytes, of these %s for tables of rays\n", grouped(run.coherence_bytes).c_str(),
              grouped(run.table_bytes).c_str());
  for (const std::string& line : whole_frames(run)) std::printf("  traced whole, %s\n", line.c_str());
}

Json cost_json(const RenderCost& cost) { return {{"rays", cost.rays}, {"ms", cost.ms}, {"cpu_ms", cost.cpu_ms}}; }

Json figures_json(const FrameFigures& f, std::uint64_t pixels) {
  return {{"pixels", pixels},
          {"whole", cost_json(f.whole)},
          {"coherent", cost_json(f.coherent)},
          {"steps_ms",
           {{"pose", f.steps.pose_ms},
            {"refit", f.steps.refit_ms},
            {"follow", f.steps.follow_ms},
            {"find", f.steps.find_ms},
            {"keep", f.steps.keep_ms}}},
          {"moving_rays", f.moving_rays},
          {"changed", f.changed},
          {"shown", f.shown},
          {"retraced", f.retraced}};
}

// Ratios of the entire sequence, then their components.
Json way_json(const SequenceRun& run) {
  if (run.frames.empty()) return Json();
  const std::size_t count = run.frames.size();
  const std::uint64_t pixels = pixel_count(run, count);
  const FrameFigures all = entire(run);
  Json frames = Json::array();
  for (const FrameFigures& f : run.frames) {
    Json json = figures_json(f, pixel_count(run, 1));
    json["frame"] = f.frame;
    json["whole_because"] = f.whole_because ? Json(f.whole_because) : Json();
    frames.push_back(json);
  }
  return {{"rays", of(all.coherent.rays, all.whole.rays)},
          {"time", time_ratio(all)},
          {"cpu_time", ratio_of(all.coherent.cpu_ms, all.whole.cpu_ms)},
          {"frame0", time_ratio(run.frames[0])},
          {"changed", of(all.changed, pixels)},
          {"shown", of(all.shown, pixels)},
          {"retraced", of(all.retraced, pixels)},
          {"entire", figures_json(all, pixels)},
          {"after_first", figures_json(sum_of(run, 1, count), pixel_count(run, count - 1))},
          {"memory", {{"coherence_bytes", run.coherence_bytes}, {"table_bytes", run.table_bytes}}},
          {"frames", frames}};
}

Json paper_json() {
  Json rows = Json::array();
  for (const PaperRatio& row : kPaperRatios)
    rows.push_back({{"frame", row.frame}, {"rays", row.rays}, {"time", row.time}});
  return {{"source", kPaperText}, {"rays", kPaperEntire.rays}, {"time", kPaperEntire.time}, {"frames", rows}};
}

std::string number(double value) { return format("%.6g", value); }

}  // namespace

std::vector<TableRow> table_rows(const SequenceRun& run, bool is_papers_scene) {
  CHECK(!run.frames.empty());
  std::vector<TableRow> rows;
  for (std::uint32_t frame : kTableFrames) {
    const std::uint32_t first = run.frames[0].frame;
    if (frame < first || frame - first >= run.frames.size()) continue;
    TableRow row = {std::to_string(frame), run.frames[frame - first], pixel_count(run, 1), nullptr};
    CHECK_EQ(row.figures.frame, frame);
    for (const PaperRatio& paper : kPaperRatios)
      if (is_papers_scene && paper.frame == frame && (frame > first || frame == 0)) row.paper = &paper;
    rows.push_back(row);
  }
  const bool as_paper = is_papers_scene && run.frames[0].frame == 0 && run.frames.size() == kPaperEntire.frame;
  rows.push_back({"entire", entire(run), pixel_count(run, run.frames.size()), as_paper ? &kPaperEntire : nullptr});
  return rows;
}

std::string papers_way_text(const Settings& settings) {
  return format(
      "the paper's way: every ray marks a table of %u x %u blocks of pixels in each voxel it passes, and whole "
      "blocks are retraced; compared with frame by frame by the same tracer, ray by ray without packets",
      settings.coherence_table, settings.coherence_table);
}

std::vector<std::string> whole_frames(const SequenceRun& run) {
  std::vector<std::string> lines;
  for (std::size_t i = 0, end; i < run.frames.size(); i = end) {
    const char* because = run.frames[i].whole_because;
    for (end = i + 1; end < run.frames.size(); ++end) {
      const char* other = run.frames[end].whole_because;
      if (!because || !other || std::strcmp(because, other) != 0) break;
    }
    const std::uint32_t first = run.frames[i].frame, last = run.frames[end - 1].frame;
    if (because)
      lines.push_back((first == last ? format("frame %u: ", first) : format("frames %u to %u: ", first, last)) +
                      because);
  }
  return lines;
}

void print_report(const CoherenceReport& report) {
  const SequenceRun& run = report.ours;
  CHECK(!run.frames.empty());
  std::printf("%s, %ux%u, %s: frames %u to %u rendered whole and coherently, equal in every bit\n",
              report.scene.c_str(), run.width, run.height, report.machine.c_str(), run.frames.front().frame,
              run.frames.back().frame);
  print_way(run, report.is_papers_scene);
  if (!report.papers_way.frames.empty()) {
    std::printf("%s\n", papers_way_text(report.settings).c_str());
    print_way(report.papers_way, report.is_papers_scene);
  }
  print_table_sweep(report.tables);
  print_image_space(report);
  if (report.is_papers_scene) std::printf("paper: %s\n", kPaperText);
}

Json report_json(const CoherenceReport& report) {
  const Settings& settings = report.settings;
  Json json = way_json(report.ours);
  json["scene"] = report.scene;
  json["machine"] = report.machine;
  json["settings"] = {{"width", settings.width},
                      {"height", settings.height},
                      {"threads", settings.threads},
                      {"samples", settings.samples_per_pixel},
                      {"depth", settings.ray_depth},
                      {"points_per_area_light", settings.points_per_area_light},
                      {"coherence_table", settings.coherence_table}};
  json["papers_way"] = way_json(report.papers_way);
  json["tables"] = table_sweep_json(report.tables);
  json["image_space"] = image_space_json(report);
  json["paper"] = report.is_papers_scene ? paper_json() : Json();
  return json;
}

std::string frames_csv(const SequenceRun& run) {
  std::string csv =
      "frame,rays_whole,rays_coherent,ms_whole,ms_coherent,cpu_ms_whole,cpu_ms_coherent,moving_rays,changed,shown,"
      "retraced,whole_because\n";
  for (const FrameFigures& f : run.frames) {
    csv += std::to_string(f.frame) + ',' + std::to_string(f.whole.rays) + ',' + std::to_string(f.coherent.rays) + ',' +
           number(f.whole.ms) + ',' + number(f.coherent.ms) + ',' + number(f.whole.cpu_ms) + ',' +
           number(f.coherent.cpu_ms);
    for (std::uint64_t count : {f.moving_rays, f.changed, f.shown, f.retraced}) csv += ',' + std::to_string(count);
    csv += ',' + csv_field(f.whole_because ? f.whole_because : "") + '\n';
  }
  return csv;
}

}  // namespace pocketray
