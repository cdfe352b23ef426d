#include "remote/server/session.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "engine/span_list.h"
#include "engine/trace_frame.h"
#include "present/pack.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kFirstPixels = 8;  // for a thread, while nothing is known of what they cost
constexpr double kLightPointNs = 80;       // of a sample; measured: 512 points, 16 samples, 0.65 ms a pixel of cornell
constexpr std::uint32_t kPartPixels = 8;   // of a row for a thread, unless as few take longer than they may

PixelFormat pack_format(WireFormat format) { return format == WireFormat::rgb565 ? kRgb565 : kRgb888; }

std::uint32_t picoseconds(std::uint64_t ns, std::uint64_t pixel_count) {
  double ps = static_cast<double>(ns) * 1000 / static_cast<double>(pixel_count);
  return ps < 4294967295.0 ? static_cast<std::uint32_t>(ps) : ~0u;
}

void send_chunk(Session* s, std::uint32_t row_begin, std::uint32_t row_end) {
  const FrameRequest& request = s->job.request;
  const Renderer& r = s->renderer;
  int width = static_cast<int>(r.settings.width), line_bytes = width * static_cast<int>(pixel_bytes(request.format));
  pack_rows(r.image.data, width, static_cast<int>(r.settings.height), static_cast<int>(row_begin),
            static_cast<int>(row_end), r.exposure, pack_format(request.format), Rotation::none, request.dither,
            s->pixels.data, line_bytes);
  std::uint32_t prefix = row_chunk_prefix_bytes(), row_count = row_end - row_begin;
  std::uint8_t* at = reserve_output(s, prefix + encoded_bytes_max(s->shape, row_count));
  Message message;
  message.type = MessageType::row_chunk;
  RowChunk* chunk = &message.row_chunk;
  chunk->frame = request.frame;
  chunk->row_begin = static_cast<std::uint16_t>(row_begin);
  chunk->row_count = static_cast<std::uint16_t>(row_count);
  chunk->pixel_ps = s->pixel_ps = picoseconds(s->job.wall_ns, s->job.pixel_count);
  std::uint32_t byte_count = encode_rows(s->encoder, row_begin, row_count,
                                         s->pixels.data + std::size_t(row_begin) * static_cast<std::size_t>(line_bytes),
                                         request.deflate_level, at + prefix, &chunk->encoding);
  add_chunk_number(chunk, s->chunk_count++);
  chunk->bytes = {at + prefix, byte_count};
  send_message(s, message);
  s->row_count += row_count;
}

// Rows of the chunk that is to be sent next; 0: all are sent.
std::uint32_t next_chunk_rows(const Session& s) {
  const FrameJob& job = s.job;
  return next_chunk_rows(job.request, job.chunk_rows, job.sent_begin - job.request.row_begin);
}

// A slice of a job as spans: one batch.
struct SliceSource {
  Session* session;
  std::uint64_t slice_ns;
  Slice slice = {};
  Span parts[kThreadCountMax];
};

// The next pixels of a row, about as many for each thread.
void next_part(SliceSource* source, std::uint32_t pixels_max, SpanBatch* batch) {
  const FrameJob& job = source->session->job;
  const Settings& settings = source->session->renderer.settings;
  std::uint32_t begin = job.traced_columns, left = settings.width - begin;
  std::uint32_t part_pixels = pixels_max < kPartPixels ? 1 : kPartPixels;
  std::uint32_t count = std::min(std::max(pixels_max, part_pixels), left);
  batch->span_count = std::min(settings.threads, (count + part_pixels - 1) / part_pixels);
  divide_row(job.traced_begin - 1, begin, begin + count, batch->span_count, source->parts);
  batch->spans = source->parts;
  source->slice = {0, begin + count, count, false};
  if (count == left) source->slice = {1, 0, count, false};
}

void next_slice(void* context, SpanBatch* batch) {
  SliceSource* source = static_cast<SliceSource*>(context);
  const Session& s = *source->session;
  const FrameJob& job = s.job;
  const Settings& settings = s.renderer.settings;
  // trace_ns is of all threads together.
  std::uint32_t pixels_max = kFirstPixels * settings.threads;
  if (s.trace_ns > 0)
    pixels_max = slice_pixels(settings, s.renderer.light_points.count, s.trace_ns * settings.threads,
                              source->slice_ns * settings.threads);
  if (job.traced_columns > 0 || pixels_max < settings.width) return next_part(source, pixels_max, batch);
  // The rest of a chunk, but enough rows for all threads to be busy to the end.
  std::uint32_t rest = next_chunk_rows(s) - (job.sent_begin - job.traced_begin);
  std::uint32_t wanted = settings.threads > 1 ? std::max(rest, 2 * settings.threads) : rest;
  std::uint32_t rows = std::min({wanted, pixels_max / settings.width, job.traced_begin - job.request.row_begin});
  batch->spans = s.renderer.spans.data + job.traced_begin - rows;
  batch->span_count = rows;
  source->slice = {rows, 0, rows * settings.width, false};
}

}  // namespace

void make_session(void* memory, std::size_t byte_count, Session* s) {
  s->block = make_arena("client", memory, byte_count);
  s->input = arena_array<std::uint8_t>(&s->block, kInputBytes);
  s->output.bytes = arena_array<std::uint8_t>(&s->block, kMessageBytesMax + kReplyBytesMax + kAheadBytes);
  s->frame_mark = arena_mark(s->block);
}

void restart_session(Session* s) {
  Arena block = s->block;
  Array<std::uint8_t> input = s->input, output = s->output.bytes;
  std::size_t frame_mark = s->frame_mark;
  std::uint64_t job_number = s->job_number;
  *s = Session();
  s->job_number = job_number;
  s->block = block;
  s->input = input;
  s->output.bytes = output;
  s->frame_mark = frame_mark;
}

std::uint8_t* reserve_output(Session* s, std::size_t byte_count) {
  OutputQueue* q = &s->output;
  CHECK_LE(byte_count, output_room(*s));
  if (q->bytes.count - q->end < byte_count) {
    std::memmove(q->bytes.data, q->bytes.data + q->begin, q->end - q->begin);
    q->end -= q->begin;
    q->begin = 0;
  }
  CHECK_LE(q->end + byte_count, q->bytes.count);
  return q->bytes.data + q->end;
}

void send_message(Session* s, const Message& message) {
  std::uint32_t byte_count = message_bytes(message);
  encode_message(message, reserve_output(s, byte_count));
  s->output.end += byte_count;
  s->queued_count += byte_count;
}

bool wants_messages(const Session& s) { return s.more_to_take && output_room(s) >= 2 * kReplyBytesMax; }

void send_error(Session* s, WireError code, std::uint32_t frame) {
  Message message;
  message.type = MessageType::error;
  message.error = {code, frame};
  send_message(s, message);
}

void drop_job(Session* s) {
  FrameJob* job = &s->job;
  if (!has_job(*s)) return;
  job->scene = nullptr;
  std::uint32_t traced = job->request.row_end - job->traced_begin, sent = job->request.row_end - job->sent_begin;
  s->ended_took_ns += job->took_ns;
  if (!job->is_view_query && traced > 0) s->ended_sent_ns += job->took_ns * sent / traced;
}

bool has_chunk(const Session& s) {
  return has_job(s) && s.job.stage == JobStage::rows && queued_bytes(s) <= kAheadBytes &&
         s.job.sent_begin - s.job.traced_begin >= next_chunk_rows(s);
}

bool can_work(const Session& s) {
  if (!has_job(s) || queued_bytes(s) > kAheadBytes) return false;
  std::uint32_t unsent = s.job.sent_begin - s.job.traced_begin;
  return s.job.stage != JobStage::rows || (s.job.traced_begin > s.job.request.row_begin && unsent < next_chunk_rows(s));
}

std::uint32_t slice_pixels(const Settings& settings, std::uint32_t light_point_count, double known_ns,
                           std::uint64_t slice_ns) {
  double most = kLightPointNs * settings.samples_per_pixel * (1.0 + light_point_count);
  double pixels = static_cast<double>(slice_ns) / std::max(known_ns, most);
  return pixels < 1 ? 1 : pixels < kChunkPixelsMax ? static_cast<std::uint32_t>(pixels) : kChunkPixelsMax;
}

Slice trace_slice(Session* s, std::uint64_t slice_ns) {
  SliceSource source;
  source.session = s, source.slice_ns = slice_ns;
  trace_frame(&s->renderer, {&source, next_slice, [](void*, const SpanBatch&) { return true; }});
  return source.slice;
}

void end_slice(Session* s, const Slice& slice, std::uint64_t took_ns, std::uint64_t wall_ns) {
  FrameJob* job = &s->job;
  if (slice.is_probe) {
    s->probe_ns = dear_pixel_ns(s->probe_ns, static_cast<double>(took_ns + 1) / slice.pixel_count);
    return;
  }
  job->traced_begin -= slice.row_count;
  job->traced_columns = slice.column_end;
  job->wall_ns += wall_ns;
  job->pixel_count += slice.pixel_count;
  s->trace_ns = dear_pixel_ns(s->trace_ns, static_cast<double>(took_ns + 1) / slice.pixel_count);
}

void send_chunks(Session* s) {
  FrameJob* job = &s->job;
  while (has_chunk(*s)) {
    std::uint32_t rows = next_chunk_rows(*s);
    send_chunk(s, job->sent_begin - rows, job->sent_begin);
    job->sent_begin -= rows;
    job->chunk_rows = rows;
    if (job->sent_begin == job->traced_begin) job->wall_ns = job->pixel_count = 0;
    if (job->sent_begin == job->request.row_begin) {
      ++s->frame_count;
      drop_job(s);
    }
  }
}

}  // namespace pocketray
