// The coarse picture that may come before a frame's rows: one pixel of each square, traced as for the frame itself.
#include <algorithm>

#include "base/check.h"
#include "engine/trace_frame.h"
#include "present/pack.h"
#include "remote/server/session.h"
#include "shade/strip.h"

namespace pocketray {
namespace {

// As in session.cpp.
constexpr std::uint32_t kFirstPixels = 8;
constexpr std::uint32_t kColumnsMax = coarse_count(kImageSideMax);

// A part of the grid of pixels as one batch of spans: tiles of a band of its rows.
struct GridPart {
  Session* session;
  std::uint32_t pixels_max;
  std::uint32_t columns = 0;
  Span spans[kColumnsMax];
};

void next_part(void* context, SpanBatch* batch) {
  GridPart* part = static_cast<GridPart*>(context);
  FrameJob* job = &part->session->job;
  const Settings& settings = part->session->renderer.settings;
  const std::uint32_t width = coarse_count(settings.width), height = coarse_count(settings.height);
  CHECK(job->coarse_row < height && job->coarse_column < width);
  if (job->coarse_column == 0)
    job->coarse_rows = part->pixels_max < kTileSide * kTileRows ? 1 : std::min(kTileRows, height - job->coarse_row);
  const std::uint32_t rows = job->coarse_rows, columns_max = kColumnsMax / kTileRows * kTileSide;
  part->columns = std::clamp(part->pixels_max / rows, 1u, std::min(width - job->coarse_column, columns_max));
  batch->spans = part->spans;
  batch->pitch = kCoarseSide;
  const std::uint32_t end = job->coarse_column + part->columns;
  for (std::uint32_t left = job->coarse_column, right; left < end; left = right) {
    right = std::min(left + kTileSide, end);
    for (std::uint32_t row = job->coarse_row; row < job->coarse_row + rows; ++row)
      part->spans[batch->span_count++] = {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(left),
                                          static_cast<std::uint16_t>(right)};
    if (settings.threads > 1) batch->spans_at_once = rows;
  }
}

}  // namespace

bool wants_coarse(const Session& session) {
  const FrameRequest& request = session.job.request;
  if (!request.coarse_first) return false;
  Message message;
  message.type = MessageType::coarse_picture;
  message.coarse_picture.pixels.count = coarse_bytes(request.settings.width, request.settings.height, request.format);
  return can_encode(message) && message_bytes(message) <= session.message_bytes_max;
}

Slice trace_coarse(Session* session, std::uint64_t slice_ns) {
  FrameJob* job = &session->job;
  CHECK(has_job(*session) && job->stage == JobStage::coarse);
  Renderer* renderer = &session->renderer;
  const std::uint32_t threads = renderer->settings.threads;
  GridPart part;
  part.session = session;
  part.pixels_max = session->trace_ns > 0 ? slice_pixels(renderer->settings, renderer->lights.points.count,
                                                         session->trace_ns * threads, slice_ns * threads)
                                          : kFirstPixels * threads;
  SpanSource source = {&part, next_part, [](void*, const SpanBatch&) { return true; }};
  trace_frame(renderer, source);
  Slice slice = {};
  slice.is_coarse = true;
  slice.pixel_count = slice.traced_count = part.columns * job->coarse_rows;
  job->coarse_column += part.columns;
  if (job->coarse_column < coarse_count(renderer->settings.width)) return slice;
  job->coarse_column = 0;
  job->coarse_row += job->coarse_rows;
  job->has_coarse = job->coarse_row == coarse_count(renderer->settings.height);
  if (job->has_coarse) job->stage = JobStage::rows;
  return slice;
}

void send_coarse(Session* session) {
  FrameJob* job = &session->job;
  CHECK(job->has_coarse);
  const Renderer& renderer = session->renderer;
  const FrameRequest& request = job->request;
  const std::uint32_t columns = coarse_count(request.settings.width), rows = coarse_count(request.settings.height);
  Message message;
  message.type = MessageType::coarse_picture;
  message.coarse_picture.frame = request.frame;
  message.coarse_picture.pixels.count = coarse_bytes(request.settings.width, request.settings.height, request.format);
  const std::uint32_t byte_count = message_bytes(message);
  std::uint8_t* at = reserve_output(&session->messages, byte_count);
  std::uint8_t* pixels = at + byte_count - message.coarse_picture.pixels.count;
  message.coarse_picture.pixels.data = pixels;
  Span spans[kColumnsMax];
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const auto x = static_cast<std::uint16_t>(i * kCoarseSide);
      spans[i] = {static_cast<std::uint16_t>(row * kCoarseSide), x, static_cast<std::uint16_t>(x + 1)};
    }
    pack_spans(renderer.image.data, static_cast<int>(renderer.settings.width), spans, columns, display_of(renderer),
               pack_format(request.format), request.dither, pixels);
    pixels += columns * pixel_bytes(request.format);
  }
  send_message(session, message);
  job->has_coarse = false;
}

}  // namespace pocketray
