#include "remote/server/session.h"

#include <algorithm>

#include "base/check.h"
#include "engine/shared_rows.h"

namespace pocketray {
namespace {

// Chosen: pixels of 0.65 ms (below) then take 5 ms, a quarter of a slice. More could overrun it before the first cost
// is known; fewer would mostly measure overhead.
constexpr std::uint32_t kFirstPixels = 8;  // per thread, while the cost of pixels is unknown
// Per light point and sample; measured: 512 points, 16 samples, 0.65 ms per pixel of cornell.
constexpr double kLightPointNs = 80;

void send_chunk(Session* session, std::uint32_t row_begin, std::uint32_t row_end) {
  CHECK_LT(row_begin, row_end);
  CHECK_LE(row_end - row_begin, session->shape.chunk_rows_max);
  const FrameRequest& request = session->job.request;
  const Renderer& renderer = session->renderer;
  const std::uint32_t* row_pixels = session->job.row_pixels;
  if (!row_pixels) pack_session_rows(session, row_begin, row_end);
  const bool states_price = session->price != session->price_stated;
  const std::uint64_t prepare_ns = session->job.rows_sent == 0 ? session->job.prepare_ns : 0;
  const bool states_preparation = prepare_ns >= kPreparationStatedNs;
  std::uint32_t prefix = row_chunk_prefix_bytes(states_price, states_preparation), row_count = row_end - row_begin;
  std::uint8_t* at = reserve_output(&session->messages, prefix + encoded_bytes_max(session->shape, row_count));
  Message message;
  message.type = MessageType::row_chunk;
  RowChunk* chunk = &message.row_chunk;
  chunk->frame = request.frame;
  chunk->row_begin = static_cast<std::uint16_t>(row_begin);
  chunk->row_count = static_cast<std::uint16_t>(row_count);
  chunk->pixel_ps = session->pixel_ps = picoseconds(session->job.work_ns, session->job.pixel_count);
  chunk->price = states_price ? session->price : 0;
  session->price_stated = session->price;
  if (states_preparation) chunk->prepare_ns = static_cast<std::uint32_t>(std::min<std::uint64_t>(prepare_ns, ~0u));
  std::uint64_t traced = 0;
  for (std::uint32_t row = row_begin; row < row_end; ++row)
    traced += row_pixels ? row_pixels[row] : count_pixels(renderer, row);
  chunk->traced = traced_part(traced, std::uint64_t(renderer.settings.width) * row_count);
  const std::size_t line_bytes = std::size_t(renderer.settings.width) * pixel_bytes(request.format);
  std::uint32_t byte_count =
      encode_rows(session->encoder, request.frame, row_begin, row_count, session->pixels.data + row_begin * line_bytes,
                  request.coding, at + prefix, &chunk->encoding);
  CHECK_EQ(chunk->encoding >> kChunkNumberShift, 0);
  session->coded_pixels += std::uint64_t(renderer.settings.width) * row_count;
  if (chunk->encoding & kEncodingCoded) session->code_bytes += byte_count;
  add_chunk_number(chunk, session->chunk_count++);
  chunk->bytes = {at + prefix, byte_count};
  send_message(session, message);
  session->row_count += row_count;
}

// Number of rows in the next chunk to send; 0: all sent.
std::uint32_t next_chunk_rows(const Session& session) { return next_chunk_rows(session.job.request, session.job.sent); }

// Number of rows to trace until another chunk is complete.
std::uint32_t rows_to_next_chunk(const FrameJob& job) {
  CHECK(has_rows(job.traced));
  std::uint32_t unsent = job.rows_traced - job.rows_sent, rows;
  for (RowSequence at = job.sent; unsent >= (rows = next_chunk_rows(job.request, at)); unsent -= rows)
    pass_rows(job.request, rows, &at);
  return rows - unsent;
}

// A slice of a job as one batch of spans.
struct SliceSource {
  Session* session;
  std::uint64_t slice_ns;
  Slice slice = {};
};

void code_beside(void* session) { send_chunks(static_cast<Session*>(session)); }

// Adds the next pixels of a row.
void next_part(SliceSource* source, std::uint32_t pixels_max, SpanBatch* batch) {
  const FrameJob& job = source->session->job;
  const Settings& settings = source->session->renderer.settings;
  CHECK_LT(job.traced_columns, settings.width);
  CHECK(has_rows(job.traced));
  Renderer* renderer = &source->session->renderer;
  const std::uint32_t row = job.traced.row_end - 1, begin = job.traced_columns;
  const std::uint32_t end = end_of_part(*renderer, row, begin, pixels_max);
  const SharedSpans part = list_part(renderer, row, begin, end);
  batch->spans = part.spans, batch->span_count = part.count;
  const std::uint32_t traced = static_cast<std::uint32_t>(span_pixel_count(part.spans, part.count));
  source->slice = {0, end, end - begin, traced, false, false};
  if (end == settings.width) source->slice = {1, 0, end - begin, traced, false, false};
}

void next_slice(void* context, SpanBatch* batch) {
  SliceSource* source = static_cast<SliceSource*>(context);
  const Session& session = *source->session;
  const FrameJob& job = session.job;
  const Settings& settings = session.renderer.settings;
  // trace_ns sums over all threads.
  std::uint32_t pixels_max = kFirstPixels * settings.threads;
  if (session.trace_ns > 0)
    pixels_max = slice_pixels(settings, session.renderer.lights.points.count, session.trace_ns * settings.threads,
                              source->slice_ns * settings.threads);
  Renderer* renderer = &source->session->renderer;
  if (job.codes_beside) batch->errand = {code_beside, source->session};
  if (job.traced_columns > 0 || pixels_max < count_pixels(*renderer, job.traced.row_end - 1))
    return next_part(source, pixels_max, batch);
  // The rest of the chunk, but enough rows to keep all threads busy to the end.
  const std::uint32_t rest = rows_to_next_chunk(job);
  std::uint32_t wanted = settings.threads > 1 ? std::max(rest, 2 * settings.threads) : rest;
  wanted = std::min(wanted, listed_rows_max(*renderer));
  RowRange ranges[kRunCountMax];
  std::uint32_t rows = 0, traced = 0, range_count = next_ranges(job, wanted, ranges);
  auto fits = [&](std::uint32_t row) {
    const std::uint32_t count = count_pixels(*renderer, row);
    if (traced + count > pixels_max) return false;
    ++rows, traced += count;
    return true;
  };
  for (std::uint32_t i = 0; i < range_count; ++i) {
    std::uint32_t row = ranges[i].end;
    while (row > ranges[i].begin && fits(row - 1)) --row;
    if (row == ranges[i].begin) continue;
    range_count = i + (row < ranges[i].end);
    ranges[i].begin = row;
  }
  CHECK(rows > 0 && rows <= job.request.row_end);
  const SharedSpans spans = list_ranges(renderer, ranges, range_count);
  batch->spans = spans.spans, batch->span_count = spans.count;
  source->slice = {rows, 0, rows * settings.width, traced, false, false};
}

// Time of a job that benefits its client: the time of sent rows, weighted by their fraction of the requested rows. A
// client that keeps requesting frames and abandons them after the first rows earns next to nothing.
std::uint64_t useful_ns(const FrameJob& job) {
  const std::uint64_t took_ns = job.took_ns - job.build_ns, asked = job.request.row_end - job.request.row_begin;
  if (job.is_view_query) return 0;
  if (asked == 0) return job.sent_light ? took_ns : 0;
  if (job.rows_traced == 0) return 0;
  return took_ns * job.rows_sent / job.rows_traced * job.rows_sent / asked;
}

}  // namespace

std::uint32_t picoseconds(std::uint64_t ns, std::uint64_t pixel_count) {
  CHECK_GT(pixel_count, 0u);
  double ps = static_cast<double>(ns) * 1000 / static_cast<double>(pixel_count);
  return ps < 4294967295.0 ? static_cast<std::uint32_t>(ps) : ~0u;
}

void make_session(void* memory, std::size_t byte_count, Session* session) {
  CHECK(memory != nullptr && session != nullptr);
  CHECK_GE(byte_count, kSessionBytesMin);
  session->block = make_arena("client", memory, byte_count);
  session->messages =
      make_message_stream(kInputBytes, kMessageBytesMax + kReplyBytesMax + kAheadBytes, &session->block);
  session->messages.message_bytes_max = kRequestBytesMax;
  session->frame_mark = arena_mark(session->block);
}

void restart_session(Session* session, platform::Link* link, int connection) {
  CHECK(session->phase == SessionPhase::unused);
  Arena block = session->block;
  MessageStream messages = session->messages;
  const std::size_t frame_mark = session->frame_mark, touched = session->touched_bytes;
  std::uint64_t job_number = session->job_number;
  *session = Session();
  session->job_number = job_number;
  session->block = block;
  session->messages = messages;
  session->frame_mark = frame_mark;
  session->touched_bytes = touched;
  start_message_stream(&session->messages, link, connection);
}

void send_message(Session* session, const Message& message) { CHECK(send_message(&session->messages, message)); }

bool wants_messages(const Session& session) {
  return session.more_to_take && output_room(session.messages) >= 2 * kReplyBytesMax;
}

void send_error(Session* session, WireError code, std::uint32_t frame) {
  Message message;
  message.type = MessageType::error;
  message.error = {code, frame};
  send_message(session, message);
}

void drop_job(Session* session) {
  FrameJob* job = &session->job;
  if (!has_job(*session)) return;
  CHECK_LE(job->rows_sent, job->rows_traced);
  job->scene = nullptr;
  CHECK_LE(job->build_ns, job->took_ns);
  session->ended_took_ns += job->took_ns;
  session->ended_build_ns += job->build_ns;
  session->ended_sent_ns += useful_ns(*job);
}

bool has_chunk(const Session& session) {
  return has_job(session) && session.job.stage == JobStage::rows && queued_bytes(session.messages) <= kAheadBytes &&
         !session.job.codes_beside &&
         (session.job.has_coarse || session.job.has_light ||
          session.job.rows_traced - session.job.rows_sent >= next_chunk_rows(session));
}

bool can_work(const Session& session) {
  if (!has_job(session) || queued_bytes(session.messages) > kAheadBytes) return false;
  std::uint32_t unsent = session.job.rows_traced - session.job.rows_sent;
  if (session.job.stage != JobStage::rows) return true;
  return !session.job.has_light && has_rows(session.job.traced) &&
         (session.job.codes_beside || unsent < next_chunk_rows(session));
}

void pack_session_rows(Session* session, std::uint32_t row_begin, std::uint32_t row_end) {
  const Renderer& renderer = session->renderer;
  const FrameRequest& request = session->job.request;
  CHECK(row_begin < row_end && row_end <= renderer.settings.height);
  const int width = static_cast<int>(renderer.settings.width);
  pack_rows(renderer.image.data, width, static_cast<int>(renderer.settings.height), static_cast<int>(row_begin),
            static_cast<int>(row_end), display_of(renderer), pack_format(request.format), Rotation::none,
            request.dither, session->pixels.data, width * static_cast<int>(pixel_bytes(request.format)));
}

std::uint32_t slice_pixels(const Settings& settings, std::uint32_t light_point_count, double known_ns,
                           std::uint64_t slice_ns) {
  double most = kLightPointNs * settings.samples_per_pixel * (1.0 + light_point_count);
  double pixels = static_cast<double>(slice_ns) / std::max(known_ns, most);
  return pixels < 1 ? 1 : pixels < kChunkPixelsMax ? static_cast<std::uint32_t>(pixels) : kChunkPixelsMax;
}

std::uint32_t next_ranges(const FrameJob& job, std::uint32_t row_count, RowRange* ranges) {
  std::uint32_t count = 0;
  for (RowSequence at = job.traced; row_count > 0 && has_rows(at) && count < kRunCountMax;) {
    const std::uint32_t rows = std::min(row_count, at.row_end - at.row_begin);
    ranges[count++] = {at.row_end - rows, at.row_end};
    row_count -= rows;
    pass_rows(job.request, rows, &at);
  }
  return count;
}

Slice trace_slice(Session* session, std::uint64_t slice_ns) {
  CHECK(has_job(*session) && session->job.stage == JobStage::rows);
  SliceSource source;
  source.session = session, source.slice_ns = slice_ns;
  SpanSource spans = {&source, next_slice, [](void*, const SpanBatch&) { return true; }};
  trace_frame(&session->renderer, spans);
  if (session->job.codes_beside) send_chunks(session);  // no pixel had to be traced
  return source.slice;
}

void end_slice(Session* session, const Slice& slice, std::uint64_t took_ns) {
  FrameJob* job = &session->job;
  CHECK_GT(slice.pixel_count, 0u);
  if (slice.is_probe) {
    session->probe_ns = dear_pixel_ns(session->probe_ns, static_cast<double>(took_ns + 1) / slice.pixel_count);
    return;
  }
  if (slice.is_coarse) {  // single pixels take longer than pixels of rows, but tell how many fit a slice
    if (session->trace_ns == 0) session->trace_ns = static_cast<double>(took_ns + 1) / slice.traced_count;
    return;
  }
  if (slice.is_light) return end_light_slice(session, slice, took_ns);
  RowRange ranges[kRunCountMax];
  const std::uint32_t range_count = next_ranges(*job, slice.row_count, ranges);
  for (std::uint32_t i = 0; i < range_count; ++i) {
    if (!job->row_pixels) finish_shared_rows(&session->renderer, ranges[i].begin, ranges[i].end);
    pass_rows(job->request, ranges[i].end - ranges[i].begin, &job->traced);
  }
  job->rows_traced += slice.row_count;
  job->traced_columns = slice.column_end;
  job->work_ns += took_ns;
  job->pixel_count += slice.pixel_count;
  if (slice.traced_count > 0 && !job->row_pixels)
    session->trace_ns = dear_pixel_ns(session->trace_ns, static_cast<double>(took_ns + 1) / slice.traced_count);
}

void send_chunks(Session* session) {
  FrameJob* job = &session->job;
  job->codes_beside = false;
  while (has_chunk(*session)) {
    if (job->has_coarse) {
      send_coarse(session);
      continue;
    }
    if (job->has_light) return send_light(session);
    std::uint32_t rows = next_chunk_rows(*session);
    send_chunk(session, job->sent.row_end - rows, job->sent.row_end);
    job->rows_sent += rows;
    pass_rows(job->request, rows, &job->sent);
    CHECK_LE(job->rows_sent, job->rows_traced);
    if (job->rows_sent == job->rows_traced) job->work_ns = job->pixel_count = 0;
    if (!has_rows(job->sent)) {
      ++session->frame_count;
      drop_job(session);
    }
  }
}

}  // namespace pocketray
