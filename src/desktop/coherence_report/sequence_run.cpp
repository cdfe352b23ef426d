#include "desktop/coherence_report/sequence_run.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/seal.h"
#include "engine/frame.h"
#include "present/pack.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

// Each renderer renders some frames in a row, as it would alone: if they took turns every frame, each would find its
// data evicted from the caches, which slows short frames the most.
constexpr std::size_t kBatchFrames = 16, kBatchBytes = 64u << 20;

struct PendingFrames {
  std::size_t frame_count = 0;        // maximum
  std::vector<Vec3> whole, coherent;  // frames in a row
  std::vector<Vec3> last;             // the frame before the batch
  std::vector<FrameFigures> figures;
  std::vector<std::uint8_t> last_shown, shown;
};

void add(const CoherentSteps& steps, CoherentSteps* sum) {
  sum->pose_ms += steps.pose_ms, sum->refit_ms += steps.refit_ms;
  sum->follow_ms += steps.follow_ms, sum->find_ms += steps.find_ms, sum->keep_ms += steps.keep_ms;
}

Status render_whole(Renderer* renderer, double seconds, bool ray_by_ray, RenderCost* cost, bool* complete) {
  const Stopwatch watch;
  RETURN_IF_ERROR(begin_frame(renderer, {seconds}));
  renderer->frame.geometry.ray_by_ray = ray_by_ray;
  *complete = trace_frame(renderer, frame_source(renderer, &interrupted));
  stop(watch, cost);
  cost->rays = ray_count(*renderer);
  return success();
}

Status render_changes(Renderer* renderer, double seconds, FrameFigures* figures, bool* complete) {
  const Stopwatch watch;
  RETURN_IF_ERROR(render_frame(renderer, changes_at(seconds, &interrupted), complete));
  const CoherenceState& state = renderer->history.state;
  stop(watch, &figures->coherent);
  figures->coherent.rays = ray_count(*renderer) + state.search.static_rays;
  figures->steps = {renderer->timings.pose_ms, renderer->timings.refit_ms, state.follow_ms, state.find_ms,
                    state.keep_ms};
  figures->moving_rays = state.search.moving_rays;
  figures->retraced = state.pixels_traced;
  figures->whole_because = state.whole_because;
  return success();
}

Status check_equal(const Vec3* whole, const Vec3* coherent, const SequenceRun& run, std::uint32_t frame) {
  const std::size_t pixels = std::size_t(run.width) * run.height;
  if (std::memcmp(whole, coherent, pixels * sizeof(Vec3)) == 0) return success();
  std::size_t pixel = 0;
  while (std::memcmp(&whole[pixel], &coherent[pixel], sizeof(Vec3)) == 0) ++pixel;
  CHECK_LT(pixel, pixels);
  return failure(
      "frame %u differs at column %zu, row %zu: the coherent frame is not the whole frame; this is a "
      "bug in pocketray: please report it",
      frame, pixel % run.width, pixel / run.width);
}

// Counts differences from the last frame. Leaves the frame as shown in last_shown.
void count_changes(const Vec3* image, const Vec3* last, const Display& display, const SequenceRun& run,
                   PendingFrames* batch, FrameFigures* figures) {
  const int width = static_cast<int>(run.width), height = static_cast<int>(run.height);
  pack_rows(image, width, height, 0, height, display, kRgb888, Rotation::none, false, batch->shown.data(), 3 * width);
  const std::size_t pixels = std::size_t(run.width) * run.height;
  for (std::size_t i = 0; i < pixels; ++i) {
    figures->changed += last == nullptr || std::memcmp(&image[i], &last[i], sizeof(Vec3)) != 0;
    figures->shown += last == nullptr || std::memcmp(&batch->shown[3 * i], &batch->last_shown[3 * i], 3) != 0;
  }
  batch->last_shown.swap(batch->shown);
}

bool was_retraced(const Renderer& renderer, std::uint32_t x, std::uint32_t y) {
  if (renderer.history.state.whole_because != nullptr) return true;
  const Coherence& c = renderer.history.coherence;
  const std::uint32_t tile = y / kChangeTileSide * c.tile_columns + x / kChangeTileSide;
  return (c.changed[tile] >> (kChangeTileSide * (y % kChangeTileSide) + x % kChangeTileSide) & 1) != 0;
}

RetracedPicture* picture_of(std::uint32_t frame, SequenceRun* run) {
  for (RetracedPicture& picture : run->pictures)
    if (picture.frame == frame) return &picture;
  return nullptr;
}

// Draws the renderer's last frame: white where it was retraced. Colours follow once the frame is packed.
void mark_picture(const Renderer& renderer, RetracedPicture* picture) {
  const Settings& settings = renderer.settings;
  CHECK_EQ(picture->rgb.size(), std::size_t(3) * settings.width * settings.height);
  for (std::uint32_t y = 0, i = 0; y < settings.height; ++y)
    for (std::uint32_t x = 0; x < settings.width; ++x, ++i)
      std::fill_n(&picture->rgb[std::size_t(3) * i], 3, was_retraced(renderer, x, y) ? 255 : 0);
}
void color_picture(const std::vector<std::uint8_t>& shown, RetracedPicture* picture) {
  CHECK_EQ(picture->rgb.size(), shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) picture->rgb[i] &= shown[i];
}

// Renders `frame_count` frames from `first` on, first all whole and then all coherently; *finished: number rendered in
// both ways.
Status render_batch(const CoherencePair& pair, std::uint32_t first, std::size_t frame_count, std::uint64_t done,
                    Progress* progress, PendingFrames* batch, SequenceRun* run, std::size_t* finished) {
  CHECK(frame_count >= 1 && frame_count <= batch->frame_count);
  const bool ray_by_ray = pair.coherent->settings.coherence_by_tables;
  const std::size_t pixels = std::size_t(run->width) * run->height;
  bool complete = true;
  *finished = 0;
  for (std::size_t i = 0; i < frame_count; ++i) {
    FrameFigures* f = &batch->figures[i];
    *f = FrameFigures();
    f->frame = first + static_cast<std::uint32_t>(i);
    RETURN_IF_ERROR(render_whole(pair.whole, seconds_of(*pair.whole, f->frame), ray_by_ray, &f->whole, &complete));
    if (!complete) return success();
    std::copy_n(pair.whole->image.data, pixels, &batch->whole[i * pixels]);
    show_progress(progress, done + i + 1);
  }
  for (std::size_t i = 0; i < frame_count; ++i) {
    FrameFigures* f = &batch->figures[i];
    RETURN_IF_ERROR(render_changes(pair.coherent, seconds_of(*pair.coherent, f->frame), f, &complete));
    if (!complete) return success();
    std::copy_n(pair.coherent->image.data, pixels, &batch->coherent[i * pixels]);
    if (RetracedPicture* picture = picture_of(f->frame, run)) mark_picture(*pair.coherent, picture);
    *finished = i + 1;
    show_progress(progress, done + frame_count + i + 1);
  }
  return success();
}

// Compares finished frames and keeps their figures.
Status keep_batch(std::size_t finished, const Display& display, PendingFrames* batch, SequenceRun* run) {
  const std::size_t pixels = std::size_t(run->width) * run->height;
  for (std::size_t i = 0; i < finished; ++i) {
    FrameFigures* f = &batch->figures[i];
    const Vec3* image = &batch->coherent[i * pixels];
    RETURN_IF_ERROR(check_equal(&batch->whole[i * pixels], image, *run, f->frame));
    const Vec3* last = run->frames.empty() ? nullptr : i > 0 ? image - pixels : batch->last.data();
    count_changes(image, last, display, *run, batch, f);
    CHECK_GE(f->retraced, f->changed);
    if (RetracedPicture* picture = picture_of(f->frame, run)) color_picture(batch->last_shown, picture);
    run->frames.push_back(*f);
  }
  if (finished > 0) std::copy_n(&batch->coherent[(finished - 1) * pixels], pixels, batch->last.begin());
  return success();
}

void make_room(const CoherencePair& pair, const FrameRange& range, PendingFrames* batch, SequenceRun* run) {
  const Renderer& renderer = *pair.coherent;
  const std::size_t pixels = std::size_t(renderer.settings.width) * renderer.settings.height;
  run->range = range;
  run->width = renderer.settings.width, run->height = renderer.settings.height;
  for (int i = 0; i < renderer.memory.plan.part_count; ++i)
    if (std::strcmp(renderer.memory.plan.parts[i].name, "coherence") == 0)
      run->coherence_bytes = renderer.memory.plan.parts[i].bytes;
  run->table_bytes = renderer.history.coherence.tables.words.bytes();
  run->frames.reserve(std::size_t(range.last) - range.first + 1);
  for (std::uint32_t frame : kFigureFrames)
    if (frame >= range.first && frame <= range.last) {
      run->pictures.push_back({frame, {}});
      run->pictures.back().rgb.resize(3 * pixels);
    }
  const std::size_t fitting = kBatchBytes / (2 * pixels * sizeof(Vec3));
  batch->frame_count = std::min(std::max(fitting, std::size_t(1)), kBatchFrames);
  batch->whole.resize(batch->frame_count * pixels), batch->coherent.resize(batch->frame_count * pixels);
  batch->figures.resize(batch->frame_count);
  batch->last.resize(pixels);
  batch->shown.resize(3 * pixels), batch->last_shown.resize(3 * pixels);
}

// Warms up, so that no measured frame pays for the first touch of memory.
Status warm_up(const CoherencePair& pair, std::uint32_t frame, bool* complete) {
  const double seconds = seconds_of(*pair.whole, frame);
  FrameFigures ignored;
  RETURN_IF_ERROR(
      render_whole(pair.whole, seconds, pair.coherent->settings.coherence_by_tables, &ignored.whole, complete));
  if (*complete) RETURN_IF_ERROR(render_changes(pair.coherent, seconds, &ignored, complete));
  forget_last_frame(&pair.coherent->history);
  return success();
}

}  // namespace

double ratio_of(double part, double whole) {
  return whole > 0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

FrameFigures sum_of(const SequenceRun& run, std::size_t begin, std::size_t end) {
  CHECK_LE(begin, end);
  CHECK_LE(end, run.frames.size());
  FrameFigures sum;
  for (std::size_t i = begin; i < end; ++i) {
    const FrameFigures& f = run.frames[i];
    add(f.whole, &sum.whole), add(f.coherent, &sum.coherent);
    add(f.steps, &sum.steps);
    sum.moving_rays += f.moving_rays;
    sum.changed += f.changed, sum.shown += f.shown, sum.retraced += f.retraced;
  }
  return sum;
}

Status run_sequence(const CoherencePair& pair, const FrameRange& range, Progress* progress, std::uint64_t done,
                    SequenceRun* run) {
  CHECK(pair.whole != nullptr && pair.coherent != nullptr && pair.whole != pair.coherent);
  CHECK(pair.coherent->history.state.planned);
  CHECK_LE(range.first, range.last);
  CHECK_GT(pair.whole->scene.info.frames_per_second, 0);
  PendingFrames batch;
  make_room(pair, range, &batch, run);
  bool complete = true;
  seal_memory();
  Status status = warm_up(pair, range.first, &complete);
  std::size_t finished, frame_count;
  for (std::uint64_t first = range.first; status.ok && complete && first <= range.last; first += frame_count) {
    frame_count = static_cast<std::size_t>(std::min<std::uint64_t>(batch.frame_count, range.last - first + 1));
    const std::uint64_t before = done + 2 * (first - range.first);
    status =
        render_batch(pair, static_cast<std::uint32_t>(first), frame_count, before, progress, &batch, run, &finished);
    if (status.ok) status = keep_batch(finished, display_of(*pair.coherent), &batch, run);
    complete = finished == frame_count;
  }
  unseal_memory();
  const std::size_t kept = run->frames.size();
  auto is_unfinished = [&](const RetracedPicture& picture) { return picture.frame - range.first >= kept; };
  run->pictures.erase(std::remove_if(run->pictures.begin(), run->pictures.end(), is_unfinished), run->pictures.end());
  return status;
}

}  // namespace pocketray
