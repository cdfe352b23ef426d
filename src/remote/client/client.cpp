#include "remote/client/client.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

// Derived: the buffers hold the longest messages queued at once and the longest ping. kLooksWatched and the number of
// watched frames are measured as in outlook.cpp.
constexpr std::size_t kOutBytes = 1024;     // for requests waiting to be sent
constexpr std::size_t kInBytesMin = 20000;  // holds the ping that measures the bandwidth
constexpr double kStartDisproved = 2;       // chosen
constexpr double kLookNs = 20e6;            // between two polls of the link: about a display frame
constexpr double kLooksWatched = 16;        // polls in a watched frame. They slow the device's packets,
constexpr std::uint64_t kWatchedFirst = 4,
                        kWatchedEvery = 16;  // so only the first frames and some later ones are watched

CodecShape codec_shape(const Settings& settings, WireFormat format) {
  return {settings.width, settings.height, std::min(kChunkRowsMax, settings.height), format};
}

std::size_t in_bytes(const CodecShape& shape, const Settings& settings, const LightOptions& light) {
  std::size_t chunk = row_chunk_prefix_bytes(true, true) + encoded_bytes_max(shape, shape.chunk_rows_max);
  return std::max({chunk, kInBytesMin, light_message_bytes_max(settings, light)});
}

// True if the device polls often in this frame to see when rows arrive: in the first frames with a server and in a few
// later ones.
bool is_watched(const Client& client) {
  return client.plan.frames_with_servers < kWatchedFirst || client.plan.frames_with_servers % kWatchedEvery == 0;
}

// Rows that the device may render between two polls of the link; few while servers are connected.
std::uint32_t rows_between_looks(const Client& client) {
  bool any = false;
  for (std::uint32_t i = 0; i < client.server_count; ++i)
    any = any || client.servers[i].overture.phase != ServerPhase::waiting;
  double row_ns = device_pixel_ns(client) * client.settings.width, look_ns = kLookNs;
  if (client.frame.joined && is_watched(client)) look_ns = std::min(look_ns, client.share.predicted_ns / kLooksWatched);
  look_ns = std::min(look_ns, work_ns_max(client));
  if (!any) return client.settings.height;
  // Uses this frame's rows so far and earlier frames, since rows below the sky cost more.
  std::uint32_t count = 0;
  for (double ns = 0; ns < look_ns && client.picture.merge.next_row + count < client.plan.model.rows.count; ++count) {
    const RowModel& row = client.plan.model.rows[client.picture.merge.next_row + count];
    ns += std::max(row_ns * static_cast<double>(row.device_part), device_row_ns(row));
  }
  return std::max(1u, count);
}

// Handles what has arrived, after waiting at most `timeout_ns`.
void look_at_servers(Client* client, std::uint64_t timeout_ns) {
  platform::LinkWait waits[kServerCountMax];
  int wait_count = 0;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    const RemoteServer& server = client->servers[i];
    if (server.overture.phase == ServerPhase::waiting) continue;
    if (server.rows.more) timeout_ns = 0;
    bool connecting = server.overture.phase == ServerPhase::connecting;
    waits[wait_count].stream = server.messages.stream;
    waits[wait_count].want_read = !connecting;
    waits[wait_count++].want_write = connecting || queued_bytes(server.messages) > 0;
  }
  std::uint64_t begin = client_now_ns(*client);
  client->unwatched_ns = begin > client->frame.looked_ns ? begin - client->frame.looked_ns : 0;
  client->link->backend->poll(client->link, waits, wait_count, timeout_ns);
  std::uint64_t now = client_now_ns(*client);
  std::uint64_t since = std::max(client->frame.looked_ns, client->frame.arrivals.asked_ns);
  client->frame.arrivals.gap_ns_max = std::max(client->frame.arrivals.gap_ns_max, now > since ? now - since : 0);
  client->frame.looked_ns = now;
  for (std::uint32_t i = 0; i < client->server_count; ++i) advance_server(client, &client->servers[i]);
  let_join(client);
}

bool is_missing(const Client& client, std::uint32_t row) {
  return client.picture.merge.rows[row].state == RowState::missing;
}

bool is_awaited(const Client& client, std::uint32_t row) {
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const ServerFrame& f = client.servers[i].rows.frame;
    if (f.open && f.row_begin <= row && row < f.row_end) return true;
  }
  return false;
}

bool awaits_rows(const Client& client) {
  return std::any_of(client.servers, client.servers + client.server_count,
                     [](const RemoteServer& server) { return server.rows.frame.open; });
}

// Takes a missing row that no server is about to send; otherwise the row that its server will send last, from the
// topmost server first. Returns false if none is missing.
bool take_latest_row(Client* client, std::uint32_t* row_begin, std::uint32_t* row_end) {
  auto take = [&](std::uint32_t row) {
    take_row(&client->picture.merge, row);
    *row_begin = row, *row_end = row + 1;
    return true;
  };
  for (std::uint32_t row = client->picture.merge.next_row; row < client->picture.merge.rows.count; ++row)
    if (is_missing(*client, row) && !is_awaited(*client, row)) return take(row);
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    const RemoteServer& server = client->servers[i];
    if (!server.rows.frame.open) continue;
    for (std::uint32_t place = run_count(server.rows.asked); place-- > 0;) {
      const RowRange run = run_at(server.rows.asked, place);
      for (std::uint32_t row = run.begin; row < run.end; ++row)
        if (is_missing(*client, row)) return take(row);
    }
  }
  return false;
}

// `given_up`: the frame ends early, which says nothing about a server that has sent no rows yet.
void cancel_rest(Client* client, bool given_up) {
  Message message;
  message.type = MessageType::cancel;
  message.cancel.frame = client->frame.request.frame;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (!server->rows.frame.open) continue;
    // None of its rows came in time, so it takes at least this long to start.
    if (!given_up && server->rows.frame.rows_come == 0 && server->overture.phase == ServerPhase::ready)
      observe_start(&client->plan.model, i, static_cast<double>(client_now_ns(*client) - server->rows.frame.asked_ns));
    server->rows.frame.open = false;
    server->light.asked_ns = 0;  // it may be on its way
    bool sent = send_message(&server->messages, message);
    sent ? flush_server(client, server) : lose_server(client, server, "it stopped reading");
  }
}

}  // namespace

std::uint64_t client_now_ns(const Client& client) {
  return platform::link_clock_ns(&client.clock, client.link->backend->now_ns(client.link));
}

std::size_t client_need(const Settings& settings, WireFormat format, std::uint32_t server_count,
                        const LightOptions& light) {
  CodecShape shape = codec_shape(settings, format);
  std::size_t each = message_stream_need(in_bytes(shape, settings, light), kOutBytes) + row_decoder_need(shape);
  return server_count * each + cost_model_need(settings.height, server_count) +
         split_need(settings.height, server_count) + merge_need(settings.height) + verifier_need(settings) +
         light_need(settings, light) + arena_need(std::size_t(settings.width) * settings.height * pixel_bytes(format));
}

Status make_client(const ClientOptions& options, const Settings& settings, const ContentHash& scene,
                   platform::Link* link, const platform::LinkAddress* servers, std::uint32_t server_count, Arena* arena,
                   Client* client) {
  CHECK_LE(server_count, kServerCountMax);
  CHECK(link != nullptr && arena != nullptr && (servers != nullptr || server_count == 0));
  CHECK_LE(options.check_count, static_cast<int>(kSpotChecksMax));
  CHECK_LE(options.device_share, 1);
  const std::size_t used = arena->used;
  *client = Client();
  client->options = options;
  client->settings = settings;
  client->scene = scene;
  client->link = link;
  client->server_count = server_count;
  CodecShape shape = codec_shape(settings, options.format);
  if (!codec_shape_valid(shape))
    return failure("servers cannot render pictures of %ux%u pixels: use a smaller --size", settings.width,
                   settings.height);
  client->picture.pixels = arena_array_zeroed<std::uint8_t>(
      arena, std::size_t(settings.width) * settings.height * pixel_bytes(options.format));
  client->picture.merge = make_merge(settings.height, arena);
  RETURN_IF_ERROR(make_verifier(options.check_count, options.entropy, settings, arena, &client->verifier));
  make_light(options.light, settings, arena, &client->light);
  client->plan.model = make_cost_model(settings.width, settings.height, server_count, arena);
  client->plan.workspace = make_split_workspace(settings.height, server_count, arena);
  client->plan.model.cost_per_device_pixel = options.cost_per_device_pixel;
  client->plan.model.cost_per_byte = options.cost_per_byte;
  client->plan.split.server_count = server_count;
  for (std::uint32_t& boundary : client->plan.split.boundary) boundary = settings.height;
  for (std::uint32_t i = 0; i < server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    server->address = servers[i];
    server->messages = make_message_stream(in_bytes(shape, settings, options.light), kOutBytes, arena);
    server->overture.timer = platform::link_timer(client_now_ns(*client), 0);
    client->plan.model.servers[i].cost_per_megabyte = options.cost_per_megabyte;
    client->plan.model.servers[i].chunk_rows = kChunkRowsMin;
    make_row_decoder(shape, arena, &server->decoder);
  }
  CHECK_LE(arena->used - used, client_need(settings, options.format, server_count, options.light));
  return success();
}

void close_client(Client* client) {
  for (std::uint32_t i = 0; i < client->server_count; ++i) close_message_stream(&client->servers[i].messages);
}

void work_until(Client* client, std::uint64_t due_ns) {
  for (std::uint64_t now = client_now_ns(*client), before = 0; now < due_ns && now != before;
       now = client_now_ns(*client)) {
    before = now;  // also if the clock was set back meanwhile: the time is up
    client->link->backend->poll(client->link, nullptr, 0, due_ns - now);
  }
}

void advance_client(Client* client, std::uint64_t timeout_ns) {
  look_at_servers(client, timeout_ns);
  // Idles for answers of the overture, within the time that a network may cost.
  while (timeout_ns == 0 && !client->frame.complete) {
    std::uint64_t wanted = wait_wanted_ns(*client);
    if (wanted == 0) return;
    double left = time_to_spare(*client, 0);
    std::uint64_t begin = client_now_ns(*client);
    // Does not spend on new servers the time that others saved.
    if (client->frame.joined)
      left = std::min(left, kWaitShare * client->share.predicted_ns - static_cast<double>(client->frame.waited_ns));
    if (left <= 0) return;
    look_at_servers(client, std::min(wanted, static_cast<std::uint64_t>(left) + 1));
    client->frame.waited_ns += client_now_ns(*client) - begin;
  }
}

void mark_dirty(Client* client, std::uint32_t row_begin, std::uint32_t row_end) {
  CHECK(row_begin <= row_end && row_end <= client->settings.height);
  if (client->picture.dirty_begin == client->picture.dirty_end)
    client->picture.dirty_begin = row_begin, client->picture.dirty_end = row_end;
  client->picture.dirty_begin = std::min(client->picture.dirty_begin, row_begin);
  client->picture.dirty_end = std::max(client->picture.dirty_end, row_end);
}

void accept_chunk(Client* client, RemoteServer* s, const RowChunk& chunk, std::uint32_t byte_count) {
  std::uint32_t begin = chunk.row_begin, end = begin + chunk.row_count, server = index_of(*client, s);
  s->rows.frame.bytes += byte_count;
  s->rows.frame.row_bytes += chunk.bytes.count;
  bool current = chunk.frame == client->frame.request.frame && !client->frame.complete;
  if (!current || begin < s->rows.frame.row_begin || end > s->rows.frame.row_end) return;
  s->rows.frame.rows_come += chunk.row_count;
  if (chunk.traced == 0) client->share.kept_rows += chunk.row_count, client->share.kept_bytes += byte_count;
  CHECK_LE(end, client->settings.height);
  s->rows.frame.heard_ns = client_now_ns(*client);
  s->rows.frame.unseen_ns = client->unwatched_ns;
  if (s->rows.frame.rows_come >= s->rows.frame.row_end - s->rows.frame.row_begin) s->rows.frame.open = false;
  if (s->overture.phase == ServerPhase::probing) s->overture.probe_ns_per_pixel = 1e-3 * chunk.pixel_ps;
  const double work_ns = 1e-3 * chunk.pixel_ps * client->settings.width * chunk.row_count;
  const double render_ns = work_ns * price_ratio(chunk.price);
  s->rows.frame.render_ns += render_ns;
  if (chunk.prepare_ns > 0) s->rows.frame.prepare_ns = chunk.prepare_ns * price_ratio(chunk.price);
  if (s->rows.frame.first_ns == 0) {
    s->rows.frame.first_ns = s->rows.frame.heard_ns;
    // Pings may all have been seen late. Minus its work, the first chunk bounds the start from above; since the link's
    // jitter raises it in single frames too, only a start that is far too long is corrected.
    const double start_ns = static_cast<double>(s->rows.frame.heard_ns - s->rows.frame.asked_ns) - work_ns;
    const Smoothed& known = client->plan.model.servers[server].start_ns;
    if (s->overture.phase == ServerPhase::ready && is_known(known) &&
        kStartDisproved * start_ns < static_cast<double>(known.value)) {
      observe_start(&client->plan.model, server, start_ns);
      s->link.round_trip_ns = std::min(s->link.round_trip_ns, start_ns);
    }
  } else {
    s->rows.frame.bytes_behind += byte_count, s->rows.frame.render_behind_ns += render_ns;
  }
  Arrivals* a = &client->frame.arrivals;
  a->last_ns = client_now_ns(*client);
  if (a->first_ns == 0)
    a->first_ns = a->last_ns;
  else
    a->bytes += byte_count;
  const double part = chunk.traced / 255.0;
  observe_server_rows(&client->plan.model, server, begin, end, work_ns, byte_count, part);
  observe_price(&client->plan.model, server, price_ratio(chunk.price));
  if (!agrees_with_device(client, s, begin, end)) return;
  if (!client->options.has_scene) compare_with_others(client, s, begin, end);
  if (s->overture.useful_ns == 0 || s->overture.told) server_is_useful(client, s);
  // Finished rows keep their pixels: a row's sender stays accountable for it.
  std::size_t row_bytes = std::size_t(client->settings.width) * pixel_bytes(client->options.format);
  for (std::uint32_t row = begin; row < end; ++row)
    if (!is_done(client->picture.merge.rows[row]))
      std::memcpy(merged_row(*client, row), picture_row(s->decoder->state, row), row_bytes);
  if (accept_rows(&client->picture.merge, chunk.frame, begin, end, server) == 0) return;
  client->frame.progress_ns = a->last_ns;
  mark_dirty(client, begin, end);
}

void begin_client_frame(Client* client, const Renderer& renderer, const FrameStart& start) {
  const bool unchanged = start.unchanged;
  CHECK(!unchanged || client->frame.complete);
  if (!client->frame.complete) {
    cancel_rest(client, true);
    end_frame(&client->plan.model, client->share.by_effect);
  }
  CHECK_EQ(renderer.settings.width, client->settings.width);
  CHECK_EQ(renderer.settings.height, client->settings.height);
  CHECK_GT(renderer.view.exposure, 0);
  FrameShare last = client->share;
  client->share = FrameShare();
  client->share.measured_ns = last.measured_ns;
  client->frame.complete = client->frame.joined = false;
  client->coarse.asked = client->coarse.shown = false;
  client->frame.waited_ns = 0, client->frame.device_ns = 0, client->frame.device_pixels = 0;
  client->frame.unchanged = client->share.unchanged = unchanged;
  client->frame.device_row = DeviceRow();
  client->frame.begin_ns = start.begin_ns;
  client->frame.prepared = start.prepared || !client->options.has_scene, client->frame.prepare_ns = start.prepare_ns;
  client->frame.arrivals = Arrivals();
  client->frame.arrivals.asked_ns = client_now_ns(*client);
  FrameRequest* q = &client->frame.request;
  ++q->frame;
  q->scene = client->scene, q->seconds = start.seconds, q->animation = renderer.view.animation;
  q->camera_stated = client->options.has_scene ||
                     renderer.view.camera_overridden;  // without the scene, an animated camera moves as on the server
  q->camera_index = static_cast<std::uint16_t>(renderer.view.camera_index);
  q->camera = renderer.view.camera;
  q->camera.node = kNone;
  q->settings = renderer.settings;
  if (client->light.by_effect) q->settings.indirect = client->options.light.indirect;
  q->exposure = renderer.view.exposure;
  q->dither = client->options.dither;
  q->format = client->options.format;
  q->coarse_first = false;
  unchanged ? void(client->picture.merge.frame = q->frame) : begin_merge(&client->picture.merge, q->frame);
  begin_checks(client);
  client->share.frame = q->frame;
  client->frame.bytes_in_before = client->frame.bytes_out_before = 0;
  bool any = false;
  if (!unchanged) measure_anew(client);
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    server->rows.frame = ServerFrame();
    client->frame.bytes_in_before += server->messages.bytes_in,
        client->frame.bytes_out_before += server->messages.bytes_out;
    any = any || server->overture.phase == ServerPhase::ready;
  }
  client->frame.held = !unchanged && any && wants_quiet(*client);
  begin_light_frame(client);
  if (any && client->options.has_scene && !client->frame.held && !unchanged && divides_rows(*client))
    share_rows(client);
  advance_client(client, 0);
}

void device_is_ready(Client* client, std::uint64_t prepare_ns) {
  CHECK(!client->frame.prepared);
  client->frame.prepared = true, client->frame.prepare_ns = prepare_ns;
}

bool has_device_rows(const Client& client) {
  if (!client.options.has_scene || has_all_rows(client)) return false;
  const std::uint32_t own_end = client.frame.joined ? client.plan.split.boundary[0] : client.settings.height;
  if (client.picture.merge.next_row < own_end) return true;
  return !awaits_rows(client) || (client.options.device_goes_on && !is_worth_waiting(client));
}

bool take_device_rows(Client* client, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end) {
  CHECK_GT(row_count_max, 0u);
  CHECK(client->frame.prepared);
  if (!has_device_rows(*client)) return false;
  row_count_max = std::min(row_count_max, rows_between_looks(*client));
  std::uint32_t own_end = client->frame.joined ? client->plan.split.boundary[0] : client->settings.height;
  std::uint32_t next = client->picture.merge.next_row;
  if (next < own_end)
    row_count_max = std::min(row_count_max, own_end - next);
  else if (awaits_rows(*client))  // takes servers' missing rows one at a time, as they may arrive any moment
    return take_latest_row(client, row_begin, row_end);
  return take_rows(&client->picture.merge, row_count_max, row_begin, row_end);
}

void finish_device_rows(Client* client, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t ns,
                        std::uint64_t pixel_count) {
  CHECK_LT(row_begin, row_end);
  const double count = row_end - row_begin, pixels = static_cast<double>(pixel_count);
  CHECK_LE(pixel_count, std::uint64_t(row_end - row_begin) * client->settings.width);
  for (std::uint32_t row = row_begin; row < row_end && divides_rows(*client); ++row)
    observe_device_row(&client->plan.model, row, static_cast<double>(ns) / count,
                       pixels / (count * client->settings.width));
  client->frame.device_ns += static_cast<double>(ns), client->frame.device_pixels += pixel_count;
  finish_rows(&client->picture.merge, row_begin, row_end);
  mark_dirty(client, row_begin, row_end);
}

void end_client_frame(Client* client) {
  CHECK(!client->frame.complete);
  CHECK(is_complete(client->picture.merge));
  client->frame.complete = true;
  FrameShare* share = &client->share;
  share->measured_ns = static_cast<double>(client_elapsed_ns(*client));
  share->device_rows = count_rows(client->picture.merge, kDeviceRows);
  share->device_pixels = client->frame.device_pixels;
  share->bytes_in = share->bytes_out = 0;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    share->server_rows[i] = count_rows(client->picture.merge, i);
    share->row_begin[i] = client->servers[i].rows.frame.row_begin,
    share->row_end[i] = client->servers[i].rows.frame.row_end;
    share->server_bytes[i] = client->servers[i].rows.frame.bytes;
    share->row_bytes += client->servers[i].rows.frame.row_bytes;
    share->bytes_in += client->servers[i].messages.bytes_in, share->bytes_out += client->servers[i].messages.bytes_out;
  }
  std::uint32_t rows = share->device_rows;
  for (std::uint32_t i = 0; i < client->server_count; ++i) rows += share->server_rows[i];
  CHECK_EQ(rows, client->picture.merge.rows.count);
  auto since = [](std::uint64_t now, std::uint64_t before) { return now > before ? now - before : 0; };
  share->bytes_in = since(share->bytes_in, client->frame.bytes_in_before);
  share->bytes_out = since(share->bytes_out, client->frame.bytes_out_before);
  measure_link(client);
  try_link(client);
  if (!client->options.has_scene) learn_row_times(client);
  if (client->frame.joined) ++client->plan.frames_with_servers;
  cancel_rest(client, false);
  if (!client->frame.unchanged) end_frame(&client->plan.model, client->share.by_effect);
  end_light_frame(client);
}

bool is_settled(const Client& client) {
  const bool is_lit = client.options.light.split == SplitKind::effect &&
                      std::any_of(client.servers, client.servers + client.server_count, [](const RemoteServer& server) {
                        return server.overture.phase == ServerPhase::ready;
                      });
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    if (server.overture.phase == ServerPhase::ready ||
        (server.overture.phase == ServerPhase::waiting && server.overture.told) ||
        (server.overture.phase == ServerPhase::probing && is_lit))
      continue;
    return false;
  }
  return true;
}

bool take_merged_rows(Client* client, std::uint32_t* row_begin, std::uint32_t* row_end) {
  CHECK(row_begin != nullptr && row_end != nullptr);
  if (client->picture.dirty_begin >= client->picture.dirty_end) return false;
  *row_begin = client->picture.dirty_begin, *row_end = client->picture.dirty_end;
  client->picture.dirty_begin = client->picture.dirty_end = 0;
  return true;
}

}  // namespace pocketray
