// pocketray render: renders a frame or a sequence into files.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/coherent_sequence.h"
#include "app/commands.h"
#include "app/render_options.h"
#include "app/render_summary.h"
#include "base/seal.h"
#include "budget/budget.h"
#include "engine/frame.h"
#include "session/aov_picture.h"
#include "session/black_picture.h"
#include "session/camera_control.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/output.h"
#include "session/picture.h"
#include "session/progress.h"
#include "session/report.h"
#include "session/resume.h"
#include "session/servers.h"

namespace pocketray {
namespace {

struct Job {
  RenderOptions options;
  RenderRequest asked;
  Servers* servers = nullptr;
  Budget* budget = nullptr;
  CoherentSequence* coherent = nullptr;  // null: frames are traced whole
  std::uint8_t* page = nullptr;          // the packed frame, for --budget-ms: packing is part of the frame time
  CameraControl camera;                  // for --orbit and --turntable
  const SceneSource* source = nullptr;
  AnimationFile* animation = nullptr;  // null: a file per picture
  Array<Span> crop_spans;              // empty: the whole picture is traced
  FrameJournal* journal = nullptr;     // null: none is kept
  std::vector<bool> is_finished;       // by an earlier run; by the frames' order, empty: none
};

constexpr std::uint64_t kProgressNs = 100'000'000;

Status render_with_servers(Renderer* renderer, const Job& job, double seconds, std::uint64_t rows_before,
                           Progress* progress, bool* complete) {
  const ServersBackend& servers = *job.servers->backend;
  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(servers.begin_frame(job.servers, renderer, seconds));
  do {
    if (servers.state(*job.servers).cut_off)
      return failure("no server answers, and the scene does not fit in --memory: start a server, or raise --memory");
    *complete = servers.advance_frame(job.servers, renderer, clock_ns() + kProgressNs, &interrupted);
    ServersState state = servers.state(*job.servers);
    if (state.disputed)
      return failure("frame discarded: two servers disagree about its pixels (--verify 0 skips the check)");
    show_progress(progress, rows_before + state.rows_done);
  } while (!*complete && !interrupted);
  renderer->timings.trace_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  return success();
}

// Renders in bands of rows, or what has changed, to show progress and to lose at most a frame when interrupted.
Status render_with_progress(Renderer* renderer, const Job& job, std::uint32_t frame, Progress* progress,
                            bool* complete) {
  const double seconds = time_of(job.options, job.asked, frame, renderer->scene.info);
  const auto rows = static_cast<std::uint32_t>(box_to_write(job.asked.picture, renderer->settings).height);
  const std::uint64_t rows_before = std::uint64_t(frame - job.asked.sequence.first) * rows;
  if (job.servers) return render_with_servers(renderer, job, seconds, rows_before, progress, complete);
  if (job.coherent) {
    RETURN_IF_ERROR(render_next(renderer, seconds, job.coherent, complete));
    show_progress(progress, rows_before + rows);
    return success();
  }
  struct Shown {
    Progress* progress;
    std::uint64_t rows_before;
  } shown = {progress, rows_before};
  SpanList bands = row_bands(renderer);
  if (!job.crop_spans.empty())
    bands.spans = job.crop_spans.data, bands.span_count = job.crop_spans.count, bands.span_ns = nullptr;
  bands.progress_context = &shown;
  bands.progress = [](void* context, std::uint32_t row_count) {
    const Shown& s = *static_cast<Shown*>(context);
    show_progress(s.progress, s.rows_before + row_count);
  };
  SpanSource source = list_source(&bands);
  source.aov = job.asked.aov;
  source.stop = &interrupted;
  return render_frame(renderer, seconds, source, complete);
}

void pack_page(Renderer* renderer, const Job& job) {
  const PictureOptions& p = job.asked.picture;
  std::uint64_t start = clock_ns();
  pack_rows(renderer->image.data, static_cast<int>(renderer->settings.width),
            static_cast<int>(renderer->settings.height), 0, static_cast<int>(renderer->settings.height),
            renderer->exposure, p.packed_format, Rotation::none, p.dither, job.page, p.packed_line_bytes);
  wait_for_pace(&renderer->pace, 0, start);
}

// Renders a single frame until its settings settle, a frame of a sequence once.
Status render_budgeted(Renderer* renderer, const Job& job, std::uint32_t frame, Progress* progress, bool* complete) {
  constexpr int kSettleFrames = 12;  // derived: as many as the ladder of builtin_front() has steps up
  RETURN_IF_ERROR(begin_budget_frame(job.budget, renderer));
  for (int i = 0; i < kSettleFrames; ++i) {
    std::uint32_t chosen = job.budget->governor.current;
    std::uint64_t start = clock_ns();
    RETURN_IF_ERROR(render_with_progress(renderer, job, frame, progress, complete));
    if (!*complete) break;
    pack_page(renderer, job);
    end_budget_frame(job.budget, clock_ns() - start);
    if (job.asked.sequence.given || i + 1 == kSettleFrames) break;
    RETURN_IF_ERROR(begin_budget_frame(job.budget, renderer));
    if (job.budget->governor.current == chosen) break;
  }
  return success();
}

Status render_one(Renderer* renderer, const Job& job, std::uint32_t frame, Progress* progress, bool* complete) {
  if (moves_camera(job.options)) {
    const float degrees = orbit_after(job.options, frame - job.asked.sequence.first);
    RETURN_IF_ERROR(set_camera(renderer, orbited_camera(job.camera, degrees)));
  }
  return job.budget ? render_budgeted(renderer, job, frame, progress, complete)
                    : render_with_progress(renderer, job, frame, progress, complete);
}

Status start_servers_for(const RenderOptions& o, Renderer* renderer, Job* job) {
  if (!job->servers) return success();
  bool raw = has_suffix(job->asked.kind.c_str(), ".raw");
  const ServersBackend& servers = *job->servers->backend;
  bool small_pixels = raw && job->asked.picture.raw_format.bits_per_pixel == 16;
  RETURN_IF_ERROR(servers.start(job->servers, renderer, small_pixels, raw && o.dither));
  MergedPicture merged = servers.picture(*job->servers);
  job->asked.picture.packed = merged.pixels;
  job->asked.picture.packed_line_bytes = merged.line_bytes;
  job->asked.picture.packed_format = merged.format;
  return success();
}

// With a budget, packing for the screen is part of the frame.
std::size_t output_bytes(const RenderOptions& o, const RenderRequest& asked, const Settings& settings) {
  std::size_t bytes = size_sum(picture_bytes(settings), animation_bytes(asked.animation, settings));
  bytes = size_sum(bytes, arena_need<Span>(static_cast<std::size_t>(asked.picture.crop.height)));
  if (o.budget.ms == 0) return bytes;
  return size_sum(bytes, arena_need(std::uint64_t(settings.width) * settings.height * 4));
}

// Opens the scene with a budget, without servers.
Status open_budgeted(const RenderOptions& o, const OutputBytes& bytes, Job* job, OpenScene* opened, Budget* budget) {
  OpenFront front;
  RETURN_IF_ERROR(open_scene_with_front(o.common, {o.budget.front}, bytes, opened, &front));
  print_notes(front);
  Renderer* renderer = &opened->renderer;
  start_budget(o.budget, front, *renderer, job->asked.sequence.last - job->asked.sequence.first + 12, budget);
  job->budget = budget;
  PictureOptions* p = &job->asked.picture;
  bool raw = has_suffix(job->asked.kind.c_str(), ".raw");
  p->packed_format = raw ? p->raw_format : kRgb888;
  p->dither = raw && o.dither;
  p->packed_line_bytes = static_cast<int>(renderer->settings.width) * p->packed_format.bits_per_pixel / 8;
  job->page = arena_array<std::uint8_t>(&renderer->frame_arena,
                                        static_cast<std::size_t>(p->packed_line_bytes) * renderer->settings.height)
                  .data;
  p->packed = job->page;
  return success();
}

// Reads which frames are finished, with --resume, and begins to list those that will be.
Status start_journal(const SceneSource& source, const Renderer& renderer, FrameJournal* journal, Job* job) {
  if (!keeps_journal(job->options, job->asked)) return success();
  const std::string path = journal_path(job->options.output);
  const std::string identity = identity_of(job->options, job->asked, source, renderer);
  const FrameRange& s = job->asked.sequence;
  std::vector<std::uint32_t> finished;
  if (job->options.resume) RETURN_IF_ERROR(read_journal(path, identity, &finished));
  job->is_finished.resize(job->asked.paths.size());
  for (std::uint32_t frame : finished)
    if (frame >= s.first && frame <= s.last)
      job->is_finished[frame - s.first] = platform::file_stamp(job->asked.paths[frame - s.first].c_str()) != 0;
  job->journal = journal;
  return begin_journal(path, identity, finished, journal);
}

// A span for each row of the crop.
void make_crop_spans(const PixelBox& crop, Renderer* renderer, Job* job) {
  if (crop.width == 0) return;
  job->crop_spans = arena_array<Span>(&renderer->frame_arena, static_cast<std::size_t>(crop.height));
  for (int i = 0; i < crop.height; ++i)
    divide_row(static_cast<std::uint32_t>(crop.top + i), static_cast<std::uint32_t>(crop.left),
               static_cast<std::uint32_t>(crop.left + crop.width), 1, &job->crop_spans[static_cast<std::uint32_t>(i)]);
}

Status start_animation(Renderer* renderer, AnimationFile* animation, Job* job) {
  if (job->asked.animation == AnimationKind::none) return success();
  const double rate = frame_rate(job->options, renderer->scene.info);
  const PixelBox box = box_to_write(job->asked.picture, renderer->settings);
  RETURN_IF_ERROR(check_animation(job->asked.animation, rate, static_cast<std::uint32_t>(box.width),
                                  static_cast<std::uint32_t>(box.height)));
  const FrameRange& s = job->asked.sequence;
  job->animation = animation;
  return begin_animation(job->asked.paths[0], job->asked.animation, rate, s.last - s.first + 1, job->asked.picture,
                         renderer, animation);
}

// In renderer.image, all of it.
bool shows_radiance(const Job& job) { return !job.servers && job.asked.aov == Aov::none && job.crop_spans.empty(); }

Status render_files(Renderer* renderer, const Job& job, RenderSummary* summary, bool* stopped) {
  const FrameRange& s = job.asked.sequence;
  const PixelBox box = box_to_write(job.asked.picture, renderer->settings);
  Progress progress =
      start_progress("rendering", std::uint64_t(s.last - s.first + 1) * static_cast<std::uint32_t>(box.height));
  Status status;
  std::vector<std::uint32_t> indices;  // of the files written
  indices.reserve(job.asked.paths.size());
  seal_memory();
  std::uint32_t written = 0;
  char black[kBlackTextBytes] = "";
  PictureOptions picture = job.asked.picture;
  AovPicture shown;
  for (std::uint32_t frame = s.first; frame <= s.last; ++frame) {
    const std::string& path = job.asked.paths[job.animation ? 0 : frame - s.first];
    if (!job.is_finished.empty() && job.is_finished[frame - s.first]) continue;
    bool complete;
    float exposure = renderer->exposure;
    status = render_one(renderer, job, frame, &progress, &complete);
    if (!status.ok) break;
    *stopped = !complete;
    if (*stopped) break;
    summary->trace_ms += renderer->timings.trace_ms;
    if (written == 0 && shows_radiance(job)) explain_black(*renderer, job.source->material_names, black);
    if (job.asked.aov != Aov::none && !has_suffix(job.asked.kind.c_str(), ".pfm")) {
      shown = color_aov(job.asked.aov, box, renderer);
      picture.legend = job.options.no_legend ? nullptr : &shown.legend;
    }
    status =
        job.animation ? add_frame(picture, renderer, job.animation) : write_picture(path.c_str(), picture, renderer);
    renderer->exposure = exposure;
    if (!status.ok) break;
    ++written;
    if (job.journal) add_to_journal(job.journal, frame);
    if (!job.animation || written == 1) indices.push_back(frame - s.first);
  }
  unseal_memory();
  end_progress(&progress);
  if (black[0]) print_note(black);
  if (status.ok && job.animation && written > 0) status = end_animation(job.animation);
  if (job.animation && (!status.ok || written == 0)) return status;  // there is no file
  for (std::uint32_t index : indices) summary->files.push_back(job.asked.paths[index]);
  summary->frame_count = written;
  summary->aov_line = shown.told;
  if (status.ok && !*stopped && job.journal && !job.options.resume) remove_journal(job.journal);
  return status;
}

int run(RenderOptions options) {
  Job job;
  Status status = read_render_options(&options, &job.asked);
  job.options = options;
  job.asked.picture.kind = job.asked.kind.c_str();
  const platform::Device* device = nullptr;
  if (status.ok) status = find_device(options.common, &device);
  if (status.ok)
    status =
        open_servers(options.parts, options.servers, options.common.emulate.empty() ? nullptr : device, &job.servers);
  ServersHandle closing(job.servers);
  OpenScene opened;
  Budget budget;
  auto bytes = [&](const Settings& settings) { return output_bytes(options, job.asked, settings); };
  if (status.ok)
    status = options.budget.ms > 0 ? open_budgeted(options, bytes, &job, &opened, &budget)
                                   : open_scene_with(job.servers, options.common, bytes, &opened);
  if (status.ok && moves_camera(options)) job.camera = make_camera_control(opened.renderer.camera, subject_of(opened));
  if (status.ok) status = start_servers_for(options, &opened.renderer, &job);
  if (status.ok) make_crop_spans(job.asked.picture.crop, &opened.renderer, &job);
  AnimationFile animation;
  if (status.ok) status = start_animation(&opened.renderer, &animation, &job);
  FrameJournal journal;
  if (status.ok) status = start_journal(opened.source, opened.renderer, &journal, &job);
  if (!status.ok && interrupted) return kExitInterrupted;
  if (!status.ok) return report(status);
  print_notes(opened);
  if (!job.servers)
    for (std::string& note : unexpected(options, job.asked, opened.renderer)) print_note(std::move(note));
  job.source = &opened.source;
  bool stopped = false;
  CoherentSequence coherent;
  if (opened.renderer.coherence_state.planned && !job.servers) job.coherent = &coherent;  // or the client uses it
  RenderSummary summary = {&job.options,
                           &opened.renderer,
                           box_to_write(job.asked.picture, opened.renderer.settings),
                           job.servers,
                           job.budget,
                           job.coherent,
                           {},
                           0,
                           0};
  status = render_files(&opened.renderer, job, &summary, &stopped);
  const auto before = std::count(job.is_finished.begin(), job.is_finished.end(), true);
  if (before > 0 && options.common.json != "-") std::printf("%td frames were finished before\n", before);
  if (summary.frame_count > 0 && options.common.json != "-") print_summary(summary);
  if (status.ok && job.budget) finish_budget(budget);
  if (status.ok && !options.common.json.empty()) status = write_json(options.common.json, to_json(summary));
  if (status.ok && stopped) {
    std::fprintf(stderr, "pocketray: interrupted; %u finished frame%s kept%s\n", summary.frame_count,
                 summary.frame_count == 1 ? " is" : "s are", job.journal ? "; add --resume to render the others" : "");
    return kExitInterrupted;
  }
  return report(status);
}

}  // namespace

void add_render_command(Command program, const OptionalParts& parts, int* exit_status) {
  auto o = std::make_shared<RenderOptions>();
  o->parts = parts;
  Command command = program.add_subcommand("render", "render a frame or a sequence to files");
  add_render_options(command, o.get());
  command.callback([=] { *exit_status = run(*o); });
}

}  // namespace pocketray
