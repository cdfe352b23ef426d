// Renders the indirect light of a frame's pixels for a device that renders the rest of the frame itself.
#include <algorithm>

#include "base/check.h"
#include "engine/trace_frame.h"
#include "remote/server/session.h"
#include "wire/light_coder.h"

namespace pocketray {
namespace {

// As in session.cpp.
constexpr std::uint32_t kFirstPixels = 8;
// Chosen: spans short enough to keep all threads busy, and at most this many at once.
constexpr std::uint32_t kSpanLights = 8, kSpansMax = 512;
// Light relative to the radiance of white that changes no display level by itself: 1/20 of the darkest level.
constexpr float kFaintest = 0x1p-16f;

std::uint32_t columns_of(const FrameRequest& q) { return light_map_side(q.settings.width, q.light_pitch); }
std::uint32_t rows_of(const FrameRequest& q) { return light_map_side(q.settings.height, q.light_pitch); }

// The next lights of the map as one batch of spans.
struct MapPart {
  Session* session;
  std::uint32_t lights_max, light_count = 0;
  Span spans[kSpansMax];
};

void next_lights(void* context, SpanBatch* batch) {
  MapPart* part = static_cast<MapPart*>(context);
  FrameJob* job = &part->session->job;
  const std::uint32_t columns = columns_of(job->request), rows = rows_of(job->request);
  CHECK(job->coarse_row < rows && job->coarse_column < columns);
  batch->spans = part->spans;
  batch->pitch = job->request.light_pitch;
  batch->spans_at_once = 1;
  while (batch->span_count < kSpansMax && part->light_count < part->lights_max && job->coarse_row < rows) {
    const std::uint32_t count =
        std::min({kSpanLights, columns - job->coarse_column, part->lights_max - part->light_count});
    part->spans[batch->span_count++] = {static_cast<std::uint16_t>(job->coarse_row),
                                        static_cast<std::uint16_t>(job->coarse_column),
                                        static_cast<std::uint16_t>(job->coarse_column + count)};
    part->light_count += count;
    job->coarse_column += count;
    if (job->coarse_column == columns) job->coarse_column = 0, ++job->coarse_row;
  }
}

}  // namespace

Status check_light_map(const Session& session) {
  const FrameRequest& request = session.job.request;
  const std::size_t bytes = light_bytes_max(std::size_t(columns_of(request)) * rows_of(request));
  if (bytes > kChunkBytesMax || light_map_prefix_bytes() + bytes > session.message_bytes_max)
    return failure("no message can hold its light");
  return success();
}

Slice trace_light(Session* session, std::uint64_t slice_ns) {
  FrameJob* job = &session->job;
  CHECK(has_job(*session) && job->stage == JobStage::light);
  Renderer* renderer = &session->renderer;
  const std::uint32_t threads = renderer->settings.threads;
  MapPart part;
  part.session = session;
  part.lights_max = kFirstPixels * threads;
  if (session->light_ns > 0)
    part.lights_max = slice_pixels(renderer->settings, renderer->lights.points.count, session->light_ns * threads,
                                   slice_ns * threads);
  SpanSource source = {&part, next_lights, [](void*, const SpanBatch&) { return true; }};
  source.aov = Aov::indirect_light;
  trace_frame(renderer, source);
  Slice slice = {};
  slice.is_light = true;
  slice.pixel_count = slice.traced_count = part.light_count;
  return slice;
}

void end_light_slice(Session* session, const Slice& slice, std::uint64_t took_ns) {
  FrameJob* job = &session->job;
  session->light_ns = dear_pixel_ns(session->light_ns, static_cast<double>(took_ns + 1) / slice.pixel_count);
  job->work_ns += took_ns, job->pixel_count += slice.pixel_count;
  job->has_light = job->coarse_row == rows_of(job->request);
  if (job->has_light) job->stage = JobStage::rows;
}

void send_light(Session* session) {
  FrameJob* job = &session->job;
  CHECK(job->has_light && job->pixel_count > 0);
  const FrameRequest& request = job->request;
  const std::uint32_t columns = columns_of(request), rows = rows_of(request);
  Renderer* renderer = &session->renderer;
  // The lights lie at their pixels; none of them moves to the place of a later one.
  Vec3* light = renderer->image.data;
  for (std::uint32_t i = 0; i < columns * rows; ++i)
    light[i] = renderer->image[std::size_t(i / columns * request.light_pitch) * renderer->settings.width +
                               i % columns * request.light_pitch];
  const std::uint32_t prefix = light_map_prefix_bytes();
  std::uint8_t* at = reserve_output(&session->messages, prefix + light_bytes_max(std::size_t(columns) * rows));
  Message message;
  message.type = MessageType::light_map;
  message.light_map.frame = request.frame;
  message.light_map.light_ps = picoseconds(job->work_ns, job->pixel_count);
  message.light_map.price = session->price_stated = session->price;
  const std::size_t bytes = encode_light(light, columns, rows, kFaintest / renderer->view.exposure, at + prefix);
  message.light_map.bytes = {at + prefix, static_cast<std::uint32_t>(bytes)};
  send_message(session, message);
  job->has_light = false, job->sent_light = true;
  job->work_ns = job->pixel_count = 0;
  job->coarse_row = job->coarse_column = 0;
  if (has_rows(job->traced)) {
    job->stage = JobStage::search;
    return;
  }
  ++session->frame_count;
  drop_job(session);
}

}  // namespace pocketray
