#include "app/render_job.h"

#include "base/check.h"
#include "engine/frame.h"
#include "session/interrupt.h"
#include "session/output.h"
#include "session/picture.h"
#include "session/servers.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kProgressNs = 100'000'000;

Status render_with_servers(Renderer* renderer, const RenderJob& job, double seconds, std::uint64_t rows_before,
                           Progress* progress, bool* complete) {
  const ServersBackend& servers = *job.servers->backend;
  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(servers.begin_frame(job.servers, renderer, seconds));
  do {
    if (servers.state(*job.servers).cut_off)
      return failure("no server answers, and the scene does not fit in --memory: start a server, or raise --memory");
    *complete = servers.advance_frame(job.servers, renderer, kProgressNs, &interrupted);
    ServersState state = servers.state(*job.servers);
    if (state.disputed)
      return failure("frame discarded: two servers disagree about its pixels (--verify 0 skips the check)");
    show_progress(progress, rows_before + state.rows_done);
  } while (!*complete && !interrupted);
  renderer->timings.trace_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  return success();
}

// Renders in bands of rows, or only changes, to show progress and to lose at most a frame when interrupted.
Status render_with_progress(Renderer* renderer, const RenderJob& job, std::uint32_t frame, RenderedFiles* files,
                            bool* complete) {
  Progress* progress = &files->progress;
  const std::uint64_t rows_before = files->rows_before;
  const double seconds = time_of(job.options, job.asked, frame, renderer->scene.info);
  const auto rows = static_cast<std::uint32_t>(box_to_write(job.asked.picture, renderer->settings).height);
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
  return render_frame(renderer, {seconds, FramePurpose::whole, source}, complete);
}

void pack_page(Renderer* renderer, const RenderJob& job) {
  const PictureOptions& p = job.asked.picture;
  std::uint64_t start = clock_ns();
  pack_rows(renderer->image.data, static_cast<int>(renderer->settings.width),
            static_cast<int>(renderer->settings.height), 0, static_cast<int>(renderer->settings.height),
            display_of(*renderer), p.packed_format, Rotation::none, p.dither, job.page, p.packed_line_bytes);
  wait_for_pace(&renderer->pace, 0, start);
}

// Renders a single frame until its settings settle, a frame of a sequence once.
Status render_budgeted(Renderer* renderer, const RenderJob& job, std::uint32_t frame, RenderedFiles* files,
                       bool* complete) {
  constexpr int kSettleFrames = 12;  // derived: the number of steps up the ladder of builtin_front()
  RETURN_IF_ERROR(begin_budget_frame(job.budget, renderer));
  for (int i = 0; i < kSettleFrames; ++i) {
    std::uint32_t chosen = job.budget->governor.current;
    std::uint64_t start = clock_ns();
    RETURN_IF_ERROR(render_with_progress(renderer, job, frame, files, complete));
    if (!*complete) break;
    pack_page(renderer, job);
    end_budget_frame(job.budget, clock_ns() - start);
    if (job.asked.sequence.given || i + 1 == kSettleFrames) break;
    RETURN_IF_ERROR(begin_budget_frame(job.budget, renderer));
    if (job.budget->governor.current == chosen) break;
  }
  return success();
}

Status render_one(Renderer* renderer, const RenderJob& job, std::uint32_t frame, RenderedFiles* files, bool* complete) {
  if (moves_camera(job.options)) {
    const float degrees = orbit_after(job.options, frame - job.asked.sequence.first);
    RETURN_IF_ERROR(set_camera(renderer, orbited_camera(job.camera, degrees)));
  }
  return job.budget ? render_budgeted(renderer, job, frame, files, complete)
                    : render_with_progress(renderer, job, frame, files, complete);
}

// True if renderer.image holds the whole frame's radiance.
bool shows_radiance(const RenderJob& job) {
  return !job.servers && job.asked.aov == Aov::none && job.crop_spans.empty();
}

}  // namespace

Status render_file(Renderer* renderer, const RenderJob& job, std::uint32_t frame, RenderedFiles* files,
                   bool* complete) {
  CHECK(frame >= job.asked.sequence.first && frame <= job.asked.sequence.last);
  const std::string& path = job.asked.paths[job.animation ? 0 : frame - job.asked.sequence.first];
  const Display display = display_of(*renderer);
  RETURN_IF_ERROR(render_one(renderer, job, frame, files, complete));
  if (!*complete) return success();
  files->trace_ms += renderer->timings.trace_ms;
  if (files->written == 0 && shows_radiance(job)) explain_picture(*renderer, job.source->material_names, files->black);
  if (job.asked.aov != Aov::none && !stores_values(job.asked.kind)) {
    files->shown = color_aov(job.asked.aov, box_to_write(job.asked.picture, renderer->settings), renderer);
    files->picture.legend = job.options.no_legend ? nullptr : &files->shown.legend;
  }
  Status status = job.animation ? add_frame(files->picture, renderer, job.animation)
                                : write_picture(path.c_str(), files->picture, renderer);
  renderer->view.exposure = display.exposure, renderer->settings.tone = display.tone;
  if (status.ok) ++files->written;
  return status;
}

}  // namespace pocketray
