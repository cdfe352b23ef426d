#include "remote/client/frame.h"

#include <algorithm>

#include "base/check.h"
#include "base/limit_list.h"
#include "engine/frame.h"
#include "engine/row_costs.h"
#include "present/pack.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Chosen: a thirtieth of the shortest frame time of interest, and as little work as cannot delay a look by long.
constexpr std::uint64_t kWaitNs = 500'000;  // between polls while waiting for rows
constexpr std::uint32_t kFirstPixels = 8;   // first part of a row while the cost of pixels is unknown

void pack_device_rows(const Renderer& renderer, Client* client, std::uint32_t row_begin, std::uint32_t row_end) {
  int width = static_cast<int>(renderer.settings.width), height = static_cast<int>(renderer.settings.height);
  bool small = client->options.format == WireFormat::rgb565;
  pack_rows(renderer.image.data, width, height, static_cast<int>(row_begin), static_cast<int>(row_end),
            renderer.exposure, small ? kRgb565 : kRgb888, Rotation::none, client->options.dither, client->pixels.data,
            width * static_cast<int>(pixel_bytes(client->options.format)));
}

// Takes as long as the emulated device takes for `pixel_count` pixels; returns that time.
std::uint64_t take_time_at(Client* client, const Pace& pace, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  std::uint64_t elapsed = client_now_ns(*client) - begin_ns;
  if (!is_paced(pace)) return elapsed;
  elapsed = paced_ns(pace, pixel_count, elapsed);
  work_until(client, begin_ns + elapsed);
  return elapsed;
}

// The same for pixels of these rows, by their relative cost.
std::uint64_t take_row_time(Client* client, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t pixel_count,
                            std::uint64_t begin_ns) {
  return take_time_at(client, pace_of_rows(client->options.pace, client->options.row_costs, row_begin, row_end),
                      pixel_count, begin_ns);
}

// The device's rows as spans; polls the servers while there are none.
struct ClientRows {
  Renderer* renderer;
  Client* client;
  std::uint32_t row_begin = 0, row_end = 0;  // of the batch, or the row rendered in parts
  std::uint32_t column_end = 0;              // of the part
  Span parts[kThreadCountMax];
};

// The next part of a row that takes longer than the time between polls. Polls the servers between parts, so that
// neither side takes the other for lost.
void next_part(ClientRows* s, SpanBatch* batch) {
  const Client& client = *s->client;
  const DeviceRow& row = client.device_row;
  const std::uint32_t width = client.settings.width;
  CHECK_LT(row.columns_done, width);
  double pixels = row.pixel_ns > 0 ? work_ns_max(client) / row.pixel_ns : kFirstPixels;
  std::uint32_t count = pixels < width ? std::max(1u, static_cast<std::uint32_t>(pixels)) : width;
  s->row_begin = row.row, s->row_end = row.row + 1;
  s->column_end = row.columns_done + std::min(count, width - row.columns_done);
  batch->span_count = std::min(s->renderer->settings.threads, s->column_end - row.columns_done);
  divide_row(row.row, row.columns_done, s->column_end, batch->span_count, s->parts);
  batch->spans = s->parts;
}

void next_rows(void* context, SpanBatch* batch) {
  ClientRows* s = static_cast<ClientRows*>(context);
  const Renderer& renderer = *s->renderer;
  Client* client = s->client;
  DeviceRow* row = &client->device_row;
  // A server may have sent the row meanwhile.
  if (row->in_parts && client->merge.rows[row->row].state != RowState::taken) row->in_parts = false;
  if (row->in_parts) return next_part(s, batch);
  if (has_all_rows(*client)) return;
  double pixel_ns = device_pixel_ns(*client), row_ns = pixel_ns * renderer.settings.width;
  bool is_long = row_ns == 0 || row_ns > work_ns_max(*client);
  if (!take_device_rows(client, is_long ? 1 : kTileRows * renderer.settings.threads, &s->row_begin, &s->row_end))
    return;
  if (is_long) {
    *row = {true, s->row_begin, 0, pixel_ns, 0};
    return next_part(s, batch);
  }
  batch->spans = renderer.spans.data + s->row_begin;
  batch->span_count = s->row_end - s->row_begin;
}

void pack_batch(void* context, const SpanBatch&) {
  const ClientRows& s = *static_cast<ClientRows*>(context);
  if (s.client->device_row.in_parts && s.column_end < s.client->settings.width) return;
  pack_device_rows(*s.renderer, s.client, s.row_begin, s.row_end);
}

std::uint64_t pace_batch(void* context, const SpanBatch& batch, std::uint64_t begin_ns) {
  const ClientRows& s = *static_cast<ClientRows*>(context);
  return take_row_time(s.client, s.row_begin, s.row_end, span_pixel_count(batch.spans, batch.span_count), begin_ns);
}

// Records the batch's time. True if all its rows are rendered.
bool finish_batch(const ClientRows& s, const SpanBatch& batch) {
  Client* client = s.client;
  DeviceRow* row = &client->device_row;
  std::uint64_t rows_ns = batch.took_ns;
  if (row->in_parts) {
    rows_ns = row->took_ns += batch.took_ns;
    row->pixel_ns = static_cast<double>(batch.took_ns + 1) / (s.column_end - row->columns_done);
    row->columns_done = s.column_end;
    row->in_parts = s.column_end < client->settings.width;
    if (row->in_parts) return false;
  }
  finish_device_rows(client, s.row_begin, s.row_end, rows_ns);
  return true;
}

// Merges what has come.
bool merge_rows(void* context, const SpanBatch& batch) {
  const ClientRows& s = *static_cast<ClientRows*>(context);
  Client* client = s.client;
  bool busy = batch.span_count > 0;
  if ((!busy || finish_batch(s, batch)) && has_all_rows(*client) && is_verified(s.renderer, client)) {
    end_client_frame(client);
    return true;
  }
  advance_client(client, busy ? 0 : kWaitNs);
  return false;
}

}  // namespace

std::uint64_t take_time(Client* client, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  return take_time_at(client, client->options.pace, pixel_count, begin_ns);
}

Status begin_frame(Renderer* renderer, Client* client, double seconds) {
  RETURN_IF_ERROR(check_limit(Quantity::seconds, seconds));
  std::uint64_t begin_ns = client_now_ns(*client);
  if (client->options.has_scene) RETURN_IF_ERROR(prepare_frame(renderer, seconds));
  // With an emulated CPU, its pace has already covered this time.
  std::uint64_t prepare_ns =
      is_paced(renderer->pace) ? client_now_ns(*client) - begin_ns : take_time(client, 0, begin_ns);
  begin_client_frame(client, *renderer, seconds, prepare_ns);
  return success();
}

bool advance_frame(Renderer* renderer, Client* client, std::uint64_t deadline_ns, const std::atomic<bool>* stop) {
  if (client->complete) return true;
  CHECK_EQ(renderer->settings.width, client->settings.width);
  CHECK_EQ(renderer->settings.height, client->settings.height);
  ClientRows rows;
  rows.renderer = renderer, rows.client = client;
  SpanSource source = {&rows, next_rows, merge_rows, pack_batch};
  source.deadline_ns = deadline_ns;
  source.stop = stop;
  source.now_ns = [](void* context) { return client_now_ns(*static_cast<ClientRows*>(context)->client); };
  source.pace = pace_batch;
  return trace_frame(renderer, source);
}

Status render_frame(Renderer* renderer, Client* client, double seconds, const std::atomic<bool>* stop, bool* complete) {
  RETURN_IF_ERROR(begin_frame(renderer, client, seconds));
  bool done = advance_frame(renderer, client, ~std::uint64_t(0), stop);
  if (complete) *complete = done;
  return success();
}

}  // namespace pocketray
