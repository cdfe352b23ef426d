// pocketray coherence-report: measures the savings from retracing only what changed, next to the paper's table.
#include <nlohmann/json.hpp>

#include "app/accuracy/accuracy_command.h"
#include "app/options.h"
#include "base/isa.h"
#include "base/limits.h"
#include "desktop/accuracy/gnuplot.h"
#include "desktop/coherence_report/page.h"
#include "plan/resolve.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr char kPapersScene[] = "seesaw";

struct ReportOptions {
  CommonOptions common;
  std::string folder, frames;
  std::uint32_t table = 16;
  bool no_paper = false, compare = false, sweep_table = false;
};

enum class Way { frame_by_frame, coherent, by_tables };

Status plan_way(Way way, const ReportOptions& o, std::uint32_t table, Renderer* renderer, const SceneStorage& storage,
                const OutputNeed& output) {
  Settings* settings = &renderer->settings;
  settings->coherence = way == Way::frame_by_frame ? CoherenceMode::off : CoherenceMode::on;
  settings->coherence_table = table;
  settings->coherence_by_tables = way == Way::by_tables;
  RETURN_IF_ERROR(plan_renderer(renderer, storage, output));
  if (!has(renderer->effects.mask, Effect::animation) || !is_animated(renderer->scene))
    return failure("%s does not move, so all its frames are equal: choose a scene with an animation, such as %s",
                   o.common.scene.c_str(), kPapersScene);
  if (o.compare && (renderer->effects.mask & kInterpolatingEffects) != 0)
    return failure(
        "--compare traces single pixels, but with --selective or --resolution they depend on others: leave these out");
  if (o.compare && (renderer->effects.mask & kInterleavedEffects) != 0)
    return failure(
        "--compare traces single pixels, but with virtual lights or shadows from the environment they depend on "
        "others: add --indirect none, or --environment-shadows 0");
  if (way == Way::frame_by_frame || renderer->history.state.planned) return success();
  if (const char* because = unfollowed_because(renderer->effects.mask, way == Way::by_tables))
    return failure("coherence does not follow these frames: %s", because);
  const CoherencePlan plan = coherence_plan(renderer->memory.plan.planned_for, renderer->lights.polygons.count);
  std::size_t bytes = renderer->memory.plan.total_bytes +
                      coherence_need(renderer->scene, renderer->effects.mask, plan) +
                      coherence_scratch_need(renderer->scene, renderer->effects.mask);
  return failure("coherence does not fit in --memory: try --memory %zuM", (bytes >> 20) + 1);
}

// `table`: side of the tables.
Status open_way(Way way, const ReportOptions& o, std::uint32_t table, OpenScene* opened) {
  OpenHooks hooks;
  hooks.output_bytes = [](const Settings&) -> std::size_t { return 0; };
  hooks.plan = [&](Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
    return plan_way(way, o, table, renderer, storage, output);
  };
  RETURN_IF_ERROR(open_scene(o.common, hooks, opened));
  return start_scene(opened, o.common);
}

FrameRange whole_animation(const Scene& scene) {
  FrameRange range;
  range.last = scene.info.frame_count > 0 ? scene.info.frame_count - 1 : 0;
  return range;
}

void describe(const ReportOptions& o, const Renderer& renderer, CoherenceReport* report) {
  const std::uint32_t threads = renderer.settings.threads;
  report->scene = o.common.scene;
  report->machine = std::to_string(threads) + (threads == 1 ? " thread, " : " threads, ") + isa_name(active_isa()) +
                    emulation_text(renderer.pace);
  report->settings = renderer.settings;
  report->is_papers_scene = o.common.scene == kPapersScene;
}

Status measure(const ReportOptions& o, CoherenceReport* report) {
  FrameRange range;
  RETURN_IF_ERROR(parse_frames(o.frames, &range));
  Progress progress;
  std::uint64_t done = 0;
  bool no_paper = o.no_paper;
  for (Way way : {Way::coherent, Way::by_tables}) {
    if (interrupted || (way == Way::by_tables && no_paper)) break;
    OpenScene whole, coherent;
    RETURN_IF_ERROR(open_way(Way::frame_by_frame, o, o.table, &whole));
    RETURN_IF_ERROR(open_way(way, o, o.table, &coherent));
    if (way == Way::coherent) {
      print_notes(coherent);
      const char* because = no_paper ? nullptr : unfollowed_because(coherent.renderer.effects.mask, true);
      if (because) {
        no_paper = true;
        print_note(std::string("the paper's way is left out: ") + because);
      }
      if (!range.given) range = whole_animation(whole.renderer.scene);
      describe(o, coherent.renderer, report);
      progress = start_progress("coherence", rendering_count(range) * (no_paper ? 1 : 2));
    }
    SequenceRun* run = way == Way::coherent ? &report->ours : &report->papers_way;
    Status status = run_sequence({&whole.renderer, &coherent.renderer}, range, &progress, done, run);
    end_progress(&progress);
    RETURN_IF_ERROR(status);
    done += rendering_count(range);
  }
  return success();
}

// Sweeps the side of the tables over the measured frames.
Status sweep_tables(const ReportOptions& o, CoherenceReport* report) {
  if (!o.sweep_table || interrupted) return success();
  report->tables.papers_way = report->ours.table_bytes == 0;
  const FrameRange& range = report->ours.range;
  Progress progress = start_progress("sides of tables", rendering_count(range) * std::size(kTableSides));
  std::uint64_t done = 0;
  for (std::uint32_t side : kTableSides) {
    OpenScene whole, coherent;
    SequenceRun run;
    RETURN_IF_ERROR(open_way(Way::frame_by_frame, o, side, &whole));
    RETURN_IF_ERROR(open_way(report->tables.papers_way ? Way::by_tables : Way::coherent, o, side, &coherent));
    Status status = run_sequence({&whole.renderer, &coherent.renderer}, range, &progress, done, &run);
    end_progress(&progress);
    RETURN_IF_ERROR(status);
    if (interrupted) break;  // its frames would not match the others'
    report->tables.sides.push_back(table_side(side, run));
    done += rendering_count(range);
  }
  return success();
}

// Runs the image-space methods over the measured frames.
Status compare(const ReportOptions& o, CoherenceReport* report) {
  if (!o.compare || interrupted) return success();
  OpenScene opened;
  RETURN_IF_ERROR(open_way(Way::frame_by_frame, o, o.table, &opened));
  const FrameRange& range = report->ours.range;
  Progress progress = start_progress("image-space methods", image_space_step_count(range));
  Status status = run_image_space(&opened.renderer, range, &progress, &report->image_space);
  end_progress(&progress);
  return status;
}

Status write_folder(const ReportOptions& o, const CoherenceReport& report) {
  if (o.folder.empty()) return success();
  bool drawn;
  RETURN_IF_ERROR(write_coherence_report(o.folder, report, &drawn));
  if (!drawn)
    std::fprintf(stderr,
                 "pocketray: no plots: gnuplot is missing or failed; install it (Debian: gnuplot), then: cd -- %s && "
                 "gnuplot *.gnuplot\n",
                 shell_word(o.folder).c_str());
  return success();
}

int run(const ReportOptions& o) {
  Status status = check_outputs({{"SCENE", o.common.scene}}, {{"--json", o.common.json}});
  if (status.ok && !o.folder.empty()) status = make_output_folder(o.folder);
  CoherenceReport coherence;
  if (status.ok) status = measure(o, &coherence);
  if (status.ok) status = sweep_tables(o, &coherence);
  if (status.ok) status = compare(o, &coherence);
  if (!status.ok) return report(status);
  const std::size_t finished = coherence.ours.frames.size() + coherence.papers_way.frames.size();
  if (coherence.ours.frames.empty()) return kExitInterrupted;
  if (o.common.json != "-") print_report(coherence);
  status = write_folder(o, coherence);
  if (status.ok && !o.common.json.empty()) status = write_json(o.common.json, report_json(coherence));
  if (status.ok && o.common.json != "-" && !o.folder.empty())
    std::printf("open %s/index.html for plots and pictures; %s/frames.csv has every frame\n", shown(o.folder).c_str(),
                shown(o.folder).c_str());
  if (status.ok && interrupted) {
    std::fprintf(stderr, "pocketray: interrupted; %zu finished frame%s kept\n", finished,
                 finished == 1 ? " is" : "s are");
    return kExitInterrupted;
  }
  return report(status);
}

}  // namespace

void add_coherence_report_command(Command program, int* exit_status) {
  auto o = std::make_shared<ReportOptions>();
  Command command = program.add_subcommand("coherence-report", "measure what retracing only what changed saves");
  add_scene_options(command, &o->common);
  add_look_options(command, &o->common);
  command.chapter("Measurement");
  command.add_option("--frames A:B", o->frames, "frames to render; the first is traced whole").default_str("all");
  command.add_option("--table N", o->table, "pixel blocks per side in each voxel's table")
      .range(1, kCoherenceTableSideMax)
      .capture_default_str()
      .details("Each block has a bit in every voxel's table of rays.");
  command.add_flag("--no-paper", o->no_paper, "skip the paper's way, which takes half of the time");
  command.add_flag("--sweep-table", o->sweep_table, "also measure tables of 1 to 128 blocks a side")
      .details("Their memory, time and pixels traced; the pictures are equal.");
  command.add_flag("--compare", o->compare, "also run the image-space methods of Badt and Chapman");
  command.chapter("Output");
  command.add_option("-o,--output DIR", o->folder, "folder for the page, plots and tables")
      .details("index.html with plots and pictures, report.json and frames.csv. Created if missing.");
  add_json_option(command, &o->common.json);
  command.everyday("Output", {"--output", "--json"});
  command.everyday("Picture", {"--size", "--threads"});
  command.everyday("Measurement", {"--frames", "--no-paper", "--table", "--sweep-table", "--compare"});
  command.example("pocketray coherence-report seesaw -o report");
  command.example("pocketray coherence-report seesaw --frames 0:40 --no-paper --json -");
  command.about(
      "Renders a sequence twice, frame by frame and by tracing only the pixels that can differ from the last frame, "
      "and "
      "compares every bit of every frame: a difference is an error. Prints rays and time of both, next to Table 2 of "
      "Jevans 1992 if the scene is seesaw, which follows its sequence. Then does the same the paper's way, with a "
      "table "
      "of rays in every voxel. --compare adds two methods that look only at pixels and miss changes, Badt 1988 and "
      "Chapman 1990: pixels traced, time, wrong pixels and ꟻLIP, as a table and plots beside ours. If interrupted, "
      "keeps "
      "the finished frames.");
  command.callback([=] {
    o->common.output_folder = o->folder;
    *exit_status = run(*o);
  });
}

}  // namespace pocketray
