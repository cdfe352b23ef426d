#include "remote/client/frame.h"

#include <algorithm>

#include "base/check.h"
#include "base/limit_list.h"
#include "engine/row_costs.h"
#include "engine/shared_rows.h"
#include "present/pack.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Chosen: a thirtieth of the shortest frame time of interest, and too little work to delay a poll by long.
constexpr std::uint64_t kWaitNs = 500'000;  // between polls while waiting for rows
constexpr std::uint32_t kFirstPixels = 8;   // first part of a row while the cost of pixels is unknown; 0.7 ms of
                                            // `cornell` on an ARM926 (progressive.cpp)

// Waits until the emulated device would have traced `pixel_count` pixels; returns that time.
std::uint64_t take_time_at(Client* client, const Pace& pace, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  std::uint64_t elapsed = client_now_ns(*client) - begin_ns;
  if (!is_paced(pace)) return elapsed;
  elapsed = paced_ns(pace, pixel_count, elapsed);
  work_until(client, begin_ns + elapsed);
  return elapsed;
}

// Waits likewise for pixels of these rows, by their relative cost.
std::uint64_t take_row_time(Client* client, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t pixel_count,
                            std::uint64_t begin_ns) {
  const ClientOptions& o = client->options;
  Pace pace = pace_of_rows(o.pace, o.row_costs, row_begin, row_end);
  if (client->light.by_effect && o.own_light_pixel_ns > 0) pace.ns_per_pixel = o.own_light_pixel_ns;
  return take_time_at(client, pace, pixel_count, begin_ns);
}

// The device's rows as spans; polls the servers while there are none.
struct ClientRows {
  Renderer* renderer;
  Client* client;
  std::uint32_t row_begin = 0, row_end = 0;   // of the batch, or the row rendered in parts
  std::uint32_t column_end = 0;               // end of the part
  std::uint64_t pixel_count = 0;              // pixels to trace in the batch
  bool lights = false;                        // light was added to rows since the servers were polled
  std::atomic<bool>* coarse_comes = nullptr;  // set when a coarse picture has come
};

void hand_out(ClientRows* s, const SharedSpans& spans, SpanBatch* batch) {
  batch->spans = spans.spans, batch->span_count = spans.count;
  s->pixel_count = span_pixel_count(spans.spans, spans.count);
}

// Takes the next part of a row that takes longer than the interval between polls. Polls the servers between parts, so
// that neither side considers the other lost.
void next_part(ClientRows* s, SpanBatch* batch) {
  const Client& client = *s->client;
  const DeviceRow& row = client.frame.device_row;
  const std::uint32_t width = client.settings.width;
  CHECK_LT(row.columns_done, width);
  double pixels = row.pixel_ns > 0 ? work_ns_max(client) / row.pixel_ns : kFirstPixels;
  std::uint32_t count = pixels < width ? std::max(1u, static_cast<std::uint32_t>(pixels)) : width;
  s->row_begin = row.row, s->row_end = row.row + 1;
  s->column_end = end_of_part(*s->renderer, row.row, row.columns_done, count);
  hand_out(s, list_part(s->renderer, row.row, row.columns_done, s->column_end), batch);
}

// Takes the device's next rows. Rows with nothing to trace are finished at once.
bool take_changed_rows(ClientRows* s, bool one_by_one) {
  const Renderer& renderer = *s->renderer;
  std::uint32_t rows_max = kTileRows * renderer.settings.threads;
  if (renderer.history.records) rows_max = std::min(4 * rows_max, listed_rows_max(renderer));
  if (one_by_one) rows_max = 1;
  while (take_device_rows(s->client, rows_max, &s->row_begin, &s->row_end)) {
    std::uint64_t pixel_count = 0;
    for (std::uint32_t row = s->row_begin; row < s->row_end; ++row) pixel_count += count_pixels(renderer, row);
    if (pixel_count > 0) return true;
    pack_device_rows(renderer, s->client, s->row_begin, s->row_end);
    finish_shared_rows(s->renderer, s->row_begin, s->row_end);
    finish_device_rows(s->client, s->row_begin, s->row_end, 0, 0);
  }
  return false;
}

void next_rows(void* context, SpanBatch* batch) {
  ClientRows* s = static_cast<ClientRows*>(context);
  const Renderer& renderer = *s->renderer;
  Client* client = s->client;
  DeviceRow* row = &client->frame.device_row;
  // A server may have sent the row meanwhile.
  if (row->in_parts && client->picture.merge.rows[row->row].state != RowState::taken) row->in_parts = false;
  if (row->in_parts) return next_part(s, batch);
  if (has_all_rows(*client)) return;
  if (!has_device_rows(*client)) {
    s->lights = light_rows(s->renderer, client);
    return;
  }
  if (!client->frame.prepared) prepare_device(s->renderer, client);
  double pixel_ns = device_pixel_ns(*client), row_ns = pixel_ns * renderer.settings.width;
  bool is_long = row_ns == 0 || row_ns > work_ns_max(*client);
  if (!take_changed_rows(s, is_long)) return;
  if (is_long) {
    *row = {true, s->row_begin, 0, pixel_ns, 0};
    return next_part(s, batch);
  }
  hand_out(s, list_rows(s->renderer, s->row_begin, s->row_end), batch);
}

void pack_batch(void* context, const SpanBatch&) {
  const ClientRows& s = *static_cast<ClientRows*>(context);
  if (s.client->frame.device_row.in_parts && s.column_end < s.client->settings.width) return;
  pack_device_rows(*s.renderer, s.client, s.row_begin, s.row_end);
}

std::uint64_t pace_batch(void* context, const SpanBatch& batch, std::uint64_t begin_ns) {
  const ClientRows& s = *static_cast<ClientRows*>(context);
  return take_row_time(s.client, s.row_begin, s.row_end, span_pixel_count(batch.spans, batch.span_count), begin_ns);
}

// Records the batch's time. Returns true if all its rows are rendered.
bool finish_batch(const ClientRows& s, const SpanBatch& batch) {
  Client* client = s.client;
  DeviceRow* row = &client->frame.device_row;
  std::uint64_t rows_ns = batch.took_ns, pixel_count = s.pixel_count;
  if (row->in_parts) {
    rows_ns = row->took_ns += batch.took_ns;
    row->pixel_ns = static_cast<double>(batch.took_ns + 1) / static_cast<double>(s.pixel_count);
    row->columns_done = s.column_end;
    row->in_parts = s.column_end < client->settings.width;
    if (row->in_parts) return false;
    pixel_count = count_pixels(*s.renderer, s.row_begin);
  }
  finish_shared_rows(s.renderer, s.row_begin, s.row_end);
  finish_device_rows(client, s.row_begin, s.row_end, rows_ns, pixel_count);
  return true;
}

// Merges the rows that have come.
bool merge_rows(void* context, const SpanBatch& batch) {
  ClientRows& s = *static_cast<ClientRows*>(context);
  Client* client = s.client;
  const bool is_tracing = batch.span_count > 0;
  const bool has_all = (!is_tracing || finish_batch(s, batch)) && has_all_rows(*client);
  if (has_all) s.lights = light_rows(s.renderer, client) || s.lights;
  if (has_all && is_lit(*client) && is_verified(s.renderer, client)) {
    if (client->options.has_scene) {
      end_frame(s.renderer);
      const Coherence& c = s.renderer->history.coherence;
      client->picture.kept_count = client->frame.prepared && c.signature.known ? c.kept_count : 0;
    }
    end_client_frame(client);
    return true;
  }
  return false;
}

// Waits for rows if the device has nothing to do.
void poll_servers(void* context, const SpanBatch& batch) {
  ClientRows& s = *static_cast<ClientRows*>(context);
  const bool is_tracing = batch.span_count > 0, was_shown = s.client->coarse.shown;
  advance_client(s.client, is_tracing || s.lights ? 0 : kWaitNs);
  s.lights = false;
  if (s.client->coarse.shown && !was_shown) *s.coarse_comes = true;
}

// Prepares the frame and finds what the device must trace of each row. Sets `unchanged` and the time taken.
Status prepare_rows(Renderer* renderer, Client* client, FrameStart* start) {
  const std::uint64_t begin_ns = client_now_ns(*client);
  FrameTask task = {start->seconds, client->light.by_effect ? FramePurpose::shared_light : FramePurpose::shared_rows};
  if (client->light.by_effect) task.first_hits = client->light.first_hits.data;
  RETURN_IF_ERROR(begin_frame(renderer, task));
  const std::uint64_t posed_ns = renderer->pace.clock->now_ns();
  start->unchanged = client->frame.complete && client->picture.kept_count > 0 &&
                     client->picture.kept_count == renderer->history.coherence.kept_count &&
                     is_shared_frame_unchanged(*renderer) && renderer->view.exposure == client->frame.request.exposure;
  search_shared_rows(renderer, ~0u);
  const float width = static_cast<float>(renderer->settings.width);
  const float own_part = client->light.by_effect ? static_cast<float>(own_light_part(*client)) : 1;
  for (std::uint32_t row = 0; row < renderer->settings.height; ++row)
    client->plan.model.rows[row].device_part = own_part * static_cast<float>(count_pixels(*renderer, row)) / width;
  wait_for_pace(&renderer->pace, 0, posed_ns);
  start->prepared = true;
  start->prepare_ns = client_now_ns(*client) - begin_ns;
  // With an emulated CPU, the renderer's pace has already covered this time.
  const Pace& pace = client->options.pace;
  if (!is_paced(renderer->pace) && is_paced(pace)) {
    start->prepare_ns = paced_prepare_ns(pace, start->prepare_ns);
    work_until(client, begin_ns + start->prepare_ns);
  }
  observe_device_start(&client->plan.model, static_cast<double>(start->prepare_ns));
  return success();
}

// Returns whether to ask servers for rows of the frame before the device has posed the scene and refitted its
// accelerator. If nothing moves, little is gained; if nothing has changed, no rows are needed; and if a node moves the
// camera, the pose must come first.
bool asks_first(const Renderer& renderer, const Client& client, double seconds) {
  const Array<const Camera>& cameras = renderer.scene.cameras;
  const bool camera_known = renderer.view.camera_overridden || renderer.view.camera_index >= cameras.count ||
                            cameras[renderer.view.camera_index].node == kNone;
  return client.options.has_scene && camera_known && renderer.pose.positions.count > 0 && !client.frame.unchanged &&
         seconds != client.frame.request.seconds;
}

}  // namespace

void pack_device_rows(const Renderer& renderer, Client* client, std::uint32_t row_begin, std::uint32_t row_end) {
  int width = static_cast<int>(renderer.settings.width), height = static_cast<int>(renderer.settings.height);
  bool small = client->options.format == WireFormat::rgb565;
  pack_rows(renderer.image.data, width, height, static_cast<int>(row_begin), static_cast<int>(row_end),
            display_of(renderer), small ? kRgb565 : kRgb888, Rotation::none, client->options.dither,
            client->picture.pixels.data, width * static_cast<int>(pixel_bytes(client->options.format)));
}

void prepare_device(Renderer* renderer, Client* client) {
  FrameStart start;
  start.seconds = client->frame.request.seconds;
  CHECK(prepare_rows(renderer, client, &start).ok);  // time and camera have been checked
  device_is_ready(client, start.prepare_ns);
}

std::uint64_t take_time(Client* client, std::uint64_t pixel_count, std::uint64_t begin_ns) {
  return take_time_at(client, client->options.pace, pixel_count, begin_ns);
}

Status begin_frame(Renderer* renderer, Client* client, double seconds) {
  RETURN_IF_ERROR(check_limit(Quantity::seconds, seconds));
  FrameStart start;
  start.seconds = seconds, start.begin_ns = client_now_ns(*client);
  RETURN_IF_ERROR(choose_split(renderer, client));
  if (client->options.has_scene && !asks_first(*renderer, *client, seconds))
    RETURN_IF_ERROR(prepare_rows(renderer, client, &start));
  begin_client_frame(client, *renderer, start);
  return success();
}

bool advance_frame(Renderer* renderer, Client* client, std::uint64_t deadline_ns, const std::atomic<bool>* stop) {
  if (client->frame.complete) return true;
  CHECK_EQ(renderer->settings.width, client->settings.width);
  CHECK_EQ(renderer->settings.height, client->settings.height);
  ClientRows rows;
  rows.renderer = renderer, rows.client = client;
  SpanSource source = {&rows, next_rows, merge_rows, pack_batch};
  source.deadline_ns = deadline_ns, source.poll = poll_servers;
  std::atomic<bool> coarse_comes{false};
  rows.coarse_comes = &coarse_comes;
  source.stop = stop ? stop : &coarse_comes;
  source.now_ns = [](void* context) { return client_now_ns(*static_cast<ClientRows*>(context)->client); };
  source.pace = pace_batch;
  return trace_frame(renderer, source);
}

Status render_frame(Renderer* renderer, Client* client, double seconds, const std::atomic<bool>* stop, bool* complete) {
  RETURN_IF_ERROR(begin_frame(renderer, client, seconds));
  bool done = false;
  do done = advance_frame(renderer, client, ~std::uint64_t(0), stop);
  while (!done && stop == nullptr);
  if (complete) *complete = done;
  return success();
}

}  // namespace pocketray
