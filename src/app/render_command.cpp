// pocketray render: renders a frame or a sequence into files.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/render_job.h"
#include "app/render_summary.h"
#include "app/render_team.h"
#include "base/seal.h"
#include "engine/frame.h"
#include "session/interrupt.h"
#include "session/note.h"
#include "session/output.h"
#include "session/picture.h"
#include "session/report.h"
#include "session/servers.h"

namespace pocketray {
namespace {

// Everything that rendering uses. Not copied, since members refer to each other.
struct Opened {
  RenderJob job;
  OpenScene scene;
  ServersHandle closing;  // before the scene, whose block holds what they need
  Budget budget;
  AnimationFile animation;
  FrameJournal journal;
  CoherentSequence coherent;
};

Status start_servers_for(const RenderOptions& o, Renderer* renderer, RenderJob* job) {
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
  if (!chooses_settings(o.budget)) return bytes;
  return size_sum(bytes, arena_need(std::uint64_t(settings.width) * settings.height * 4));
}

// True if pictures keep 8 bits of each channel.
bool shows_24_bits(const RenderRequest& asked) {
  return !has_suffix(asked.kind.c_str(), ".raw") || asked.picture.raw_format.bits_per_pixel > 16;
}

// Opens the scene with a budget, without servers.
Status open_budgeted(const RenderOptions& o, const OutputBytes& bytes, RenderJob* job, OpenScene* opened,
                     Budget* budget) {
  OpenFront front;
  RETURN_IF_ERROR(
      open_scene_with_front(o.common, front_source(o.budget, shows_24_bits(job->asked)), bytes, opened, &front));
  print_notes(front);
  Renderer* renderer = &opened->renderer;
  start_budget(o.budget, front, *renderer, job->asked.sequence.last - job->asked.sequence.first + 12, budget);
  job->budget = budget;
  PictureOptions* p = &job->asked.picture;
  bool raw = has_suffix(job->asked.kind.c_str(), ".raw");
  p->packed_format = raw ? p->raw_format : kRgb888;
  p->dither = raw && o.dither;
  p->packed_line_bytes = static_cast<int>(renderer->settings.width) * p->packed_format.bits_per_pixel / 8;
  job->page = arena_array<std::uint8_t>(&renderer->memory.frame,
                                        static_cast<std::size_t>(p->packed_line_bytes) * renderer->settings.height)
                  .data;
  p->packed = job->page;
  return success();
}

// Reads which frames are finished, with --resume, and begins the journal of those to come.
Status start_journal(const SceneSource& source, const Renderer& renderer, FrameJournal* journal, RenderJob* job) {
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

// Makes one span for each row of the crop.
void make_crop_spans(const PixelBox& crop, Renderer* renderer, RenderJob* job) {
  if (crop.width == 0) return;
  job->crop_spans = arena_array<Span>(&renderer->memory.frame, static_cast<std::size_t>(crop.height));
  for (int i = 0; i < crop.height; ++i)
    job->crop_spans[static_cast<std::uint32_t>(i)] =
        row_span(static_cast<std::uint32_t>(crop.top + i), static_cast<std::uint32_t>(crop.left),
                 static_cast<std::uint32_t>(crop.left + crop.width));
}

Status start_animation(Renderer* renderer, AnimationFile* animation, RenderJob* job) {
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

// Reads the options and opens the scene. Ranks that help neither print nor keep a journal.
Status open_job(const RenderOptions& given, Opened* o) {
  RenderJob* job = &o->job;
  job->options = given;
  RenderOptions* options = &job->options;
  options->common.threads = team_threads(options->parts.team, options->common.threads);
  RETURN_IF_ERROR(read_render_options(options, &job->asked));
  job->asked.picture.kind = job->asked.kind.c_str();
  for (const std::string& path : job->asked.paths) options->common.outputs.push_back({"-o", path});
  const platform::Device* device = nullptr;
  RETURN_IF_ERROR(find_device(options->common, &device));
  Status status =
      open_servers(options->parts, options->servers, options->common.emulate.empty() ? nullptr : device, &job->servers);
  o->closing.reset(job->servers);
  RETURN_IF_ERROR(status);
  auto bytes = [job](const Settings& settings) { return output_bytes(job->options, job->asked, settings); };
  RETURN_IF_ERROR(chooses_settings(options->budget) ? open_budgeted(*options, bytes, job, &o->scene, &o->budget)
                                                    : open_scene_with(job->servers, options->common, bytes, &o->scene));
  Renderer* renderer = &o->scene.renderer;
  if (moves_camera(*options)) job->camera = make_camera_control(renderer->view.camera, subject_of(o->scene));
  RETURN_IF_ERROR(start_servers_for(*options, renderer, job));
  make_crop_spans(job->asked.picture.crop, renderer, job);
  RETURN_IF_ERROR(start_animation(renderer, &o->animation, job));
  if (leads(options->parts.team)) RETURN_IF_ERROR(start_journal(o->scene.source, *renderer, &o->journal, job));
  job->source = &o->scene.source;
  if (renderer->history.state.planned && !job->servers) job->coherent = &o->coherent;  // otherwise the client uses it
  return success();
}

std::uint64_t row_count(const RenderJob& job, const Renderer& renderer) {
  return static_cast<std::uint64_t>(box_to_write(job.asked.picture, renderer.settings).height);
}

// Returns the frames that no earlier run has finished.
std::vector<std::uint32_t> frames_to_render(const RenderJob& job) {
  std::vector<std::uint32_t> frames;
  const FrameRange& s = job.asked.sequence;
  for (std::uint32_t frame = s.first; frame <= s.last; ++frame)
    if (job.is_finished.empty() || !job.is_finished[frame - s.first]) frames.push_back(frame);
  return frames;
}

// Renders all frames, alone or with the helpers of a team. `written` has room for all of them.
Status render_all(Opened* o, RenderedFiles* files, std::vector<std::uint32_t>* written, bool* stopped) {
  const RenderJob& job = o->job;
  Renderer* renderer = &o->scene.renderer;
  const Team& team = job.options.parts.team;
  const std::uint64_t rows = row_count(job, *renderer);
  auto finish = [&](std::uint32_t frame) {
    if (job.journal) add_to_journal(job.journal, frame);
    written->push_back(frame);
    files->rows_before += rows;
  };
  const std::vector<std::uint32_t> frames = frames_to_render(job);
  std::size_t next = 0;
  std::unique_ptr<FrameLead> lead;
  if (team.size > 1)
    lead = std::make_unique<FrameLead>(team, identity_of(job.options, job.asked, o->scene.source, *renderer), frames,
                                       [&](const SharedFrame& shared) {
                                         finish(shared.frame);
                                         files->trace_ms += shared.trace_ms;
                                         add_coherence(shared.coherent, &o->coherent);
                                         show_progress(&files->progress, files->rows_before);
                                       });
  seal_memory();
  for (;;) {
    std::uint32_t frame = 0;
    bool there = next < frames.size();
    if (lead) {
      SealPause pause;
      RETURN_IF_ERROR(lead->next(&frame, &there));
    } else if (there) {
      frame = frames[next++];
    }
    if (!there) break;
    bool complete;
    RETURN_IF_ERROR(render_file(renderer, job, frame, files, &complete));
    if (complete) finish(frame);
    if (!complete && !lead) break;  // a team's leader still collects what the others have finished
  }
  *stopped = written->size() < frames.size();
  return success();
}

Status render_files(Opened* o, RenderSummary* summary, bool* stopped) {
  RenderJob* job = &o->job;
  const FrameRange& s = job->asked.sequence;
  RenderedFiles files;
  files.picture = job->asked.picture;
  const std::uint64_t rows = row_count(*job, o->scene.renderer);
  files.rows_before =
      rows * static_cast<std::uint64_t>(std::count(job->is_finished.begin(), job->is_finished.end(), true));
  files.progress = start_progress("rendering", (s.last - s.first + 1) * rows);
  std::vector<std::uint32_t> written;
  written.reserve(s.last - s.first + 1);
  Status status = render_all(o, &files, &written, stopped);
  unseal_memory();
  end_progress(&files.progress);
  if (files.black[0]) print_note(files.black);
  if (status.ok && job->animation && !written.empty()) status = end_animation(job->animation);
  summary->trace_ms = files.trace_ms;
  if (job->animation && (!status.ok || written.empty())) return status;  // there is no file
  std::sort(written.begin(), written.end());
  if (job->animation) summary->files.push_back(job->asked.paths[0]);
  if (!job->animation)
    for (std::uint32_t frame : written) summary->files.push_back(job->asked.paths[frame - s.first]);
  summary->frame_count = static_cast<std::uint32_t>(written.size());
  summary->aov_line = files.shown.told;
  if (status.ok && !*stopped && job->journal && !job->options.resume) remove_journal(job->journal);
  return status;
}

int lead(const RenderOptions& given) {
  Opened o;
  Status status = open_job(given, &o);
  const RenderJob& job = o.job;
  const RenderOptions& options = job.options;
  if (!status.ok && interrupted) return kExitInterrupted;
  if (!status.ok) return report(status);
  const bool shows_hits = job.asked.aov != Aov::none && job.asked.aov != Aov::cost;
  print_notes(o.scene, shows_hits ? options.aov.c_str() : nullptr);
  if (!job.servers)
    for (std::string& note : unexpected(options, job.asked, o.scene.renderer)) print_note(std::move(note));
  bool stopped = false;
  RenderSummary summary = {&job.options,
                           &o.scene.renderer,
                           box_to_write(job.asked.picture, o.scene.renderer.settings),
                           job.servers,
                           job.budget,
                           job.coherent,
                           {},
                           0,
                           0};
  status = render_files(&o, &summary, &stopped);
  const auto before = std::count(job.is_finished.begin(), job.is_finished.end(), true);
  if (before > 0 && options.common.json != "-") std::printf("%td frames were finished before\n", before);
  if (summary.frame_count > 0 && options.common.json != "-") print_summary(summary);
  if (status.ok && job.budget) finish_budget(o.budget);
  if (status.ok && !options.common.json.empty()) status = write_json(options.common.json, to_json(summary));
  if (status.ok && stopped) {
    std::fprintf(stderr, "pocketray: interrupted; %u finished frame%s kept%s\n", summary.frame_count,
                 summary.frame_count == 1 ? " is" : "s are", job.journal ? "; add --resume to render the others" : "");
    return kExitInterrupted;
  }
  return report(status);
}

// Renders the frames that the leader assigns.
Status help(const TeamMessage& message, Opened* o, RenderedFiles* files) {
  return render_given_frames(o->job.options.parts.team, message, [&](SharedFrame* shared, bool* complete) {
    const double trace_ms = files->trace_ms;
    o->coherent = CoherentSequence();
    seal_memory();
    Status status = render_file(&o->scene.renderer, o->job, shared->frame, files, complete);
    unseal_memory();
    shared->trace_ms = files->trace_ms - trace_ms;
    shared->coherent = o->coherent;
    return status;
  });
}

int run(const RenderOptions& options) {
  const Team& team = options.parts.team;
  std::unique_ptr<Opened> helper;
  RenderedFiles files;
  auto open = [&] {
    helper = std::make_unique<Opened>();
    RETURN_IF_ERROR(open_job(options, helper.get()));
    files.picture = helper->job.asked.picture;
    tell_ready_for_frames(
        team, identity_of(helper->job.options, helper->job.asked, helper->scene.source, helper->scene.renderer));
    return success();
  };
  return run_in_team(
      team, [&] { return lead(options); }, open,
      [&](const TeamMessage& message) { return help(message, helper.get(), &files); });
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
