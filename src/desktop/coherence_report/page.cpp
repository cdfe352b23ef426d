#include "desktop/coherence_report/page.h"

#include <map>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "desktop/accuracy/page_parts.h"
#include "desktop/accuracy/report.h"
#include "desktop/accuracy/strip.h"
#include "desktop/accuracy/text.h"
#include "desktop/coherence_report/image_space_report.h"
#include "desktop/coherence_report/plots.h"
#include "present/png_file.h"
#include "session/gnuplot.h"
#include "session/output.h"

namespace pocketray {
namespace {

struct ReportPictures {
  std::map<std::string, std::string> plots;           // text of SVG
  std::map<std::uint32_t, std::string> retraced_png;  // bytes, by frame
};

std::string share(std::uint64_t part, std::uint64_t whole) {
  return figure(100 * ratio_of(static_cast<double>(part), static_cast<double>(whole)), 3) + " %";
}

std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }

std::string table_of(const SequenceRun& run, bool is_papers_scene) {
  std::string head = "<th>frame</th><th>rays, whole</th><th>coherent</th><th>ratio</th><th>pixels</th>";
  if (is_papers_scene) head += "<th>paper</th>";
  head += "<th>ms, whole</th><th>coherent</th><th>ratio</th>";
  if (is_papers_scene) head += "<th>paper</th>";
  std::string text = "<div class=\"box\"><table><thead><tr>" + head + "</tr></thead>\n<tbody>\n";
  for (const TableRow& row : table_rows(run, is_papers_scene)) {
    const FrameFigures& f = row.figures;
    auto ratio = [](double part, double whole) { return cell(format("<b>%.4f</b>", ratio_of(part, whole))); };
    auto paper = [&](double PaperRatio::*value) {
      return is_papers_scene ? cell(row.paper ? format("%.4f", row.paper->*value) : "") : "";
    };
    text += "<tr><th>" + row.name + "</th>" + cell(grouped(f.whole.rays)) + cell(grouped(f.coherent.rays)) +
            ratio(static_cast<double>(f.coherent.rays), static_cast<double>(f.whole.rays)) +
            ratio(static_cast<double>(f.retraced), static_cast<double>(row.pixels)) + paper(&PaperRatio::rays) +
            cell(format("%.2f", f.whole.ms)) + cell(format("%.2f", f.coherent.ms)) + ratio(f.coherent.ms, f.whole.ms) +
            paper(&PaperRatio::time) + "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

std::string answer_of(const SequenceRun& run) {
  const FrameFigures all = entire(run), after = sum_of(run, 1, run.frames.size());
  const std::uint64_t pixels = std::uint64_t(run.width) * run.height * (run.frames.size() - 1);
  std::string text = "<p class=\"answer\">All " + std::to_string(run.frames.size()) +
                     " frames are equal in every bit. Retracing only what changed takes <b>" +
                     share(all.coherent.rays, all.whole.rays) + "</b> of the rays and <b>" +
                     figure(100 * ratio_of(all.coherent.ms, all.whole.ms), 3) + " %</b> of the time.";
  if (pixels > 0)
    text += " After the first frame, " + share(after.changed, pixels) + " of the pixels change, " +
            share(after.shown, pixels) + " as shown in 8 bits; " + share(after.retraced, pixels) + " are retraced.";
  return text + "</p>\n";
}

std::string notes_of(const SequenceRun& run) {
  std::string text = "<ul class=\"soft\">\n<li>Memory of coherence: " + grouped(run.coherence_bytes) +
                     " bytes, of these " + grouped(run.table_bytes) + " for tables of rays.</li>\n";
  for (const std::string& line : whole_frames(run)) text += "<li>Traced whole, " + escaped(line) + ".</li>\n";
  return text + "</ul>\n";
}

std::string plot_of(const ReportPictures& pictures, const std::string& name) {
  auto found = pictures.plots.find(name);
  return found == pictures.plots.end() ? "" : svg_figure(name, found->second);
}

std::string retraced_of(const ReportPictures& pictures) {
  if (pictures.retraced_png.empty()) return "";
  std::string text =
      "<h2>Retraced pixels</h2>\n<p>As in figure 4 of the paper: the retraced pixels of a frame, all others "
      "black.</p>\n"
      "<div class=\"tiles\">\n";
  for (const auto& picture : pictures.retraced_png) {
    std::string name = "Frame " + std::to_string(picture.first);
    text += "<figure>" + image(picture.second, name) + "<figcaption>" + name + "</figcaption></figure>\n";
  }
  return text + "</div>\n";
}

std::string tables_of(const TableSweep& sweep, const ReportPictures& pictures) {
  if (sweep.sides.empty()) return "";
  return "<h2>Side of the tables of rays</h2>\n<p>Here, " + escaped(table_sweep_text(sweep)) + ".</p>\n" +
         table_sweep_markup(sweep) + plot_of(pictures, "tables");
}

std::string image_space_of(const CoherenceReport& report, const ReportPictures& pictures) {
  if (report.image_space.frame_count == 0) return "";
  return "<h2>Image-space methods</h2>\n<p>" + escaped(kImageSpaceText) + "</p>\n" + image_space_table(report) +
         pair(plot_of(pictures, "wrong"), plot_of(pictures, "flip"));
}

std::string page_of(const CoherenceReport& report, const ReportPictures& pictures) {
  const SequenceRun& run = report.ours;
  std::string title =
      "Savings from retracing only what changed: " + escaped(report.scene.substr(report.scene.rfind('/') + 1));
  std::string text =
      page_begin(title) + "<header>\n<div>\n<h1>" + title + "</h1>\n<p class=\"soft\">" + escaped(report.scene) +
      format(", %u × %u pixels, ", run.width, run.height) + escaped(report.machine) +
      format(", frames %u to %u", run.frames.front().frame, run.frames.back().frame) + "</p>\n</div>\n</header>\n" +
      answer_of(run) + "<h2>Rays and time</h2>\n" + table_of(run, report.is_papers_scene);
  if (report.is_papers_scene) text += "<p class=\"soft\">Paper: " + escaped(kPaperText) + "</p>\n";
  text += notes_of(run) + pair(plot_of(pictures, "rays"), plot_of(pictures, "time"));
  if (!report.papers_way.frames.empty())
    text += "<h2>The paper’s way</h2>\n<p>T" + escaped(papers_way_text(report.settings).substr(1)) + ".</p>\n" +
            table_of(report.papers_way, report.is_papers_scene) + notes_of(report.papers_way);
  return text + tables_of(report.tables, pictures) + image_space_of(report, pictures) + retraced_of(pictures) +
         "<h2>Method</h2>\n<p class=\"soft\">Two renderers, each in its own memory, render the sequence, one "
         "as whole frames, the other only what may have changed since its last frame; they take turns every few "
         "frames. Times "
         "cover posing, refitting, placing lights, the search for changes and tracing. Rays are of all kinds, "
         "including those of the search that pass through the whole scene. frames.csv has every frame, report.json "
         "every "
         "figure.</p>\n" +
         kPageEnd;
}

Status write_pictures(const std::string& folder, const SequenceRun& run, ReportPictures* pictures) {
  for (const RetracedPicture& picture : run.pictures) {
    std::string* png = &pictures->retraced_png[picture.frame];
    RETURN_IF_ERROR(encode_png({run.width, run.height, picture.rgb}, png));
    RETURN_IF_ERROR(write_file(folder + format("/retraced-%04u.png", picture.frame), *png));
  }
  return success();
}

}  // namespace

Status write_coherence_report(const std::string& folder, const CoherenceReport& report, bool* drawn) {
  CHECK(drawn != nullptr);
  CHECK(!report.ours.frames.empty());
  *drawn = false;
  ReportPictures pictures;
  RETURN_IF_ERROR(write_file(folder + "/frames.csv", frames_csv(report.ours)));
  if (!report.papers_way.frames.empty())
    RETURN_IF_ERROR(write_file(folder + "/frames_papers_way.csv", frames_csv(report.papers_way)));
  RETURN_IF_ERROR(write_json(folder + "/report.json", report_json(report)));
  RETURN_IF_ERROR(write_pictures(folder, report.ours, &pictures));
  std::vector<Plot> plots = {rays_plot(report), time_plot(report)};
  if (report.image_space.frame_count > 0) {
    RETURN_IF_ERROR(write_file(folder + "/image_space.csv", image_space_csv(report)));
    plots.push_back(wrong_plot(report)), plots.push_back(flip_plot(report));
  }
  if (!report.tables.sides.empty()) {
    RETURN_IF_ERROR(write_file(folder + "/tables.csv", table_sweep_csv(report.tables)));
    plots.push_back(table_plot(report.tables));
  }
  RETURN_IF_ERROR(draw_plots(folder, plots, write_file, run_gnuplot, &pictures.plots, drawn));
  return write_file(folder + "/index.html", page_of(report, pictures));
}

}  // namespace pocketray
