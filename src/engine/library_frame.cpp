// Frames for the library's caller: whole or refined, packed into the caller's pixels.
#include <algorithm>
#include <climits>
#include <cstring>

#include "base/check.h"
#include "base/limit_list.h"
#include "engine/frame.h"
#include "engine/library.h"
#include "present/pack.h"

namespace pocketray {
namespace {

constexpr PixelFormat kFormats[] = {kXrgb8888, kXbgr8888, kRgb565, kBgr565, kRgb888, kBgr888};
constexpr int kFormatCount = POCKETRAY_RGB_FLOAT + 1;
static_assert(sizeof kFormats / sizeof kFormats[0] == POCKETRAY_RGB_FLOAT, "one for each format but floats");

// A caller's checked pixels.
struct Target {
  void* data;
  int line_bytes;
  int format;
  Rotation rotation;
  bool dither;
};

Status read_pixels(const pocketray_pixels* given, const Settings& settings, Target* target) {
  pocketray_pixels p = POCKETRAY_PIXELS_INIT;
  RETURN_IF_ERROR(read_struct("the pixels", given, &p));
  if (!p.data) return failure("the pixels' data is a null pointer: pass a buffer for the picture");
  RETURN_IF_ERROR(check_choice("the pixels' format", p.format, kFormatCount));
  RETURN_IF_ERROR(check_choice("dither", p.dither, 2));
  if (!rotation_from_degrees(p.rotation_degrees, &target->rotation))
    return failure("the picture is rotated by %d degrees: it must be 0, 90, 180 or 270", p.rotation_degrees);
  bool floats = p.format == POCKETRAY_RGB_FLOAT;
  if (floats && target->rotation != Rotation::none) return failure("linear radiance is not rotated: pass 0 degrees");
  bool turned = target->rotation == Rotation::quarter || target->rotation == Rotation::three_quarters;
  std::size_t columns = turned ? settings.height : settings.width, rows = turned ? settings.width : settings.height;
  std::size_t bits = floats ? 8 * sizeof(Vec3) : static_cast<std::size_t>(kFormats[p.format].bits_per_pixel);
  std::size_t row_bytes = columns * bits / 8, alignment = floats ? sizeof(float) : bits == 24 ? 1 : bits / 8;
  if (p.line_bytes < row_bytes || p.line_bytes > INT_MAX)
    return failure("a row of %zu pixels needs %zu bytes, line_bytes is %zu", columns, row_bytes, p.line_bytes);
  if (p.line_bytes % alignment || reinterpret_cast<std::uintptr_t>(p.data) % alignment)
    return failure("rows of these pixels must be aligned to %zu bytes", alignment);
  std::uint64_t needed = std::uint64_t(p.line_bytes) * (rows - 1) + row_bytes;
  if (p.byte_count < needed)
    return failure("%zu rows need %llu bytes, byte_count is %zu", rows, static_cast<unsigned long long>(needed),
                   p.byte_count);
  target->data = p.data;
  target->line_bytes = static_cast<int>(p.line_bytes);
  target->format = p.format;
  target->dither = p.dither != 0;
  return success();
}

void write_pixels(const Renderer& renderer, std::uint32_t row_begin, std::uint32_t row_end, const Target& target) {
  CHECK_LE(row_begin, row_end);
  CHECK_LE(row_end, renderer.settings.height);
  CHECK(target.format >= 0 && target.format < kFormatCount);
  int width = static_cast<int>(renderer.settings.width), height = static_cast<int>(renderer.settings.height);
  if (target.format != POCKETRAY_RGB_FLOAT) {
    pack_rows(renderer.image.data, width, height, static_cast<int>(row_begin), static_cast<int>(row_end),
              display_of(renderer), kFormats[target.format], target.rotation, target.dither, target.data,
              target.line_bytes);
    return;
  }
  std::size_t row_pixels = renderer.settings.width;
  for (std::size_t row = row_begin; row < row_end; ++row)
    std::memcpy(static_cast<std::uint8_t*>(target.data) + row * static_cast<std::size_t>(target.line_bytes),
                renderer.image.data + row * row_pixels, row_pixels * sizeof(Vec3));
}

Status check_rendering(const pocketray_instance* instance, double seconds) {
  RETURN_IF_ERROR(check_instance(instance));
  return check_limit(Quantity::seconds, seconds);
}

void clear_costs(pocketray_instance* instance) {
  Renderer* renderer = &instance->renderer;
  std::memset(renderer->row_ns.data, 0, renderer->row_ns.bytes());
  renderer->timings.trace_ms = 0;
  instance->rows_done = 0;
  instance->refining = false;
}

// Number of complete rows of the frame, from the top.
std::uint32_t rows_done(const Renderer& renderer) {
  const FrameSpans& own = renderer.history.spans;
  if (own.list.done_count < own.list.span_count) return own.list.spans[own.list.done_count].row;
  return own.all ? renderer.settings.height : std::min(own.tile_row * kChangeTileSide, renderer.settings.height);
}

// Renders the frame, or where coherence is planned the pixels that may have changed. Calls the progress function, if
// any, after each band of rows; it may end the frame.
Status render(pocketray_instance* instance, double seconds) {
  // The function may set another one for the next frame.
  const pocketray_progress progress = instance->progress;
  void* const user = instance->progress_user;
  Renderer* renderer = &instance->renderer;
  const FramePurpose purpose = renderer->history.state.planned ? FramePurpose::changes : FramePurpose::whole;
  RETURN_IF_ERROR(begin_frame(renderer, {seconds, purpose}));
  for (bool ended = false; !ended;) {
    ended = trace_frame(renderer, frame_source(renderer, &instance->stop, progress ? 0 : kNoDeadline));
    instance->rows_done = ended ? renderer->settings.height : rows_done(*renderer);
    if (!ended && instance->stop.load(std::memory_order_relaxed)) break;
    if (progress) ended |= progress(user, instance->rows_done, renderer->settings.height) != 0;
  }
  return success();
}

}  // namespace
}  // namespace pocketray

using namespace pocketray;

pocketray_result pocketray_render(pocketray_instance* instance, double seconds, const pocketray_pixels* pixels) {
  Status status = check_rendering(instance, seconds);
  Target target;
  if (status.ok) status = read_pixels(pixels, instance->renderer.settings, &target);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  Renderer* renderer = &instance->renderer;
  clear_costs(instance);
  status = render(instance, seconds);
  if (!status.ok) return refuse(POCKETRAY_ERROR_SCENE, status);
  CHECK_LE(instance->rows_done, renderer->settings.height);
  write_pixels(*renderer, 0, instance->rows_done, target);
  return instance->rows_done < renderer->settings.height ? POCKETRAY_STOPPED : POCKETRAY_OK;
}

pocketray_result pocketray_begin(pocketray_instance* instance, double seconds) {
  Status status = check_rendering(instance, seconds);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  clear_costs(instance);
  status = begin_frame(&instance->renderer, {seconds});
  if (!status.ok) return refuse(POCKETRAY_ERROR_SCENE, status);
  instance->progressive = Progressive();
  instance->progressive.row_ns = instance->renderer.row_ns.data;
  instance->refining = true;
  return POCKETRAY_OK;
}

pocketray_result pocketray_refine(pocketray_instance* instance, double milliseconds, const pocketray_pixels* pixels) {
  constexpr double kMillisecondsMax = 1e12;  // 31 years; a deadline of 10¹⁸ ns fits into 64 bits
  Status status = check_instance(instance);
  if (status.ok && !(milliseconds >= 0 && milliseconds <= kMillisecondsMax))
    status = failure("milliseconds is %g: it must lie in 0 … %g", milliseconds, kMillisecondsMax);
  Target target;
  if (status.ok) status = read_pixels(pixels, instance->renderer.settings, &target);
  if (status.ok && !instance->refining) status = failure("there is no frame to refine: begin one after every change");
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);

  Renderer* renderer = &instance->renderer;
  Progressive* progressive = &instance->progressive;
  std::uint64_t deadline = clock_ns() + static_cast<std::uint64_t>(milliseconds * 1e6);
  pocketray_result result = POCKETRAY_UNFINISHED;
  while (result == POCKETRAY_UNFINISHED) {
    if (instance->stop.load(std::memory_order_relaxed)) {
      result = POCKETRAY_STOPPED;
      break;
    }
    if (advance_progressive(renderer, instance->tile_spans, 0, progressive)) result = POCKETRAY_OK;  // one batch
    if (clock_ns() >= deadline) break;
  }
  instance->rows_done = finished_rows(*renderer, *progressive);
  std::uint32_t begin, end;
  if (take_dirty_rows(progressive, &begin, &end)) write_pixels(*renderer, begin, end, target);
  return result;
}

void pocketray_set_stop(pocketray_instance* instance, int stop) {
  if (instance) instance->stop.store(stop != 0, std::memory_order_relaxed);
}

pocketray_result pocketray_set_progress(pocketray_instance* instance, pocketray_progress progress, void* user) {
  Status status = check_instance(instance);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  instance->progress = progress;
  instance->progress_user = user;
  return POCKETRAY_OK;
}

pocketray_result pocketray_get_frame(const pocketray_instance* instance, pocketray_frame* frame) {
  Status status = check_instance(instance);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  const Renderer& renderer = instance->renderer;
  Tracer counts = total_counts(renderer);
  pocketray_frame result = POCKETRAY_FRAME_INIT;
  result.build_ms = renderer.timings.build_ms;
  result.pose_ms = renderer.timings.pose_ms;
  result.refit_ms = renderer.timings.refit_ms;
  result.trace_ms = renderer.timings.trace_ms;
  for (std::uint64_t rays : counts.rays) result.ray_count += rays;
  result.rays_skipped = counts.rays_left_out;
  result.rows_done = instance->rows_done;
  result.row_count = renderer.settings.height;
  const CoherenceState& coherence = renderer.history.state;
  result.pixels_traced =
      coherence.planned ? coherence.pixels_traced : std::uint64_t(instance->rows_done) * renderer.settings.width;
  result.whole_because = coherence.planned ? coherence.whole_because : coherence.unplanned_because;
  return to_result(write_struct("the frame", result, frame), POCKETRAY_ERROR_ARGUMENT);
}

pocketray_result pocketray_get_row_costs(const pocketray_instance* instance, std::uint64_t* nanoseconds,
                                         std::uint32_t row_count) {
  Status status = check_instance(instance);
  if (!status.ok) return refuse(POCKETRAY_ERROR_ARGUMENT, status);
  if (!nanoseconds) return refuse(POCKETRAY_ERROR_ARGUMENT, failure("nanoseconds: a null pointer"));
  if (row_count != instance->renderer.settings.height)
    return refuse(POCKETRAY_ERROR_ARGUMENT,
                  failure("row_count is %u, the picture has %u rows", row_count, instance->renderer.settings.height));
  Array<std::uint64_t> row_ns = instance->renderer.row_ns;
  CHECK_EQ(row_ns.count, row_count);
  std::memcpy(nanoseconds, row_ns.data, row_ns.bytes());
  return POCKETRAY_OK;
}
