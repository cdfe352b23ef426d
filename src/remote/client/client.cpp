#include "remote/client/client.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr std::size_t kOutBytes = 1024;     // of requests that wait to be sent
constexpr std::size_t kInBytesMin = 20000;  // holds the ping that measures the bandwidth
constexpr double kWaitShare = 0.03;         // of a frame's time that the device may wait in vain: less than the 5 %
                                            // that a network may cost, of which checks take one
constexpr double kCertainPart = 0.5;        // of what a row is thought to take: rows are measured several at a time
constexpr double kLateFactor = 1.03;        // of a frame's predicted time, after which nobody waits for rows; and of
                                            // the device's alone, likewise
constexpr double kLookNs = 20e6;            // between two looks at the link: a frame that a screen shows
constexpr double kLooksWatched = 16;  // in a frame that is watched. It costs the device's packets some of their speed:
constexpr std::uint64_t kWatchedFirst = 4, kWatchedEvery = 16;  // so only the first of these and each of those is

CodecShape codec_shape(const Settings& settings, WireFormat format) {
  return {settings.width, settings.height, std::min(kChunkRowsMax, settings.height), format};
}

std::size_t in_bytes(const CodecShape& shape) {
  std::size_t chunk = row_chunk_prefix_bytes() + encoded_bytes_max(shape, shape.chunk_rows_max);
  return std::max(chunk, kInBytesMin);
}

void mark_dirty(Client* c, std::uint32_t begin, std::uint32_t end) {
  if (c->dirty_begin == c->dirty_end) c->dirty_begin = begin, c->dirty_end = end;
  c->dirty_begin = std::min(c->dirty_begin, begin);
  c->dirty_end = std::max(c->dirty_end, end);
}

// Frames in which the device looks often, so that it sees when rows come: the first ones with a server, and a few
// later.
bool is_watched(const Client& c) { return c.frames_shared < kWatchedFirst || c.frames_shared % kWatchedEvery == 0; }

// How much longer the device may do nothing in this frame, so that it is done within 1 + kWaitShare times what it takes
// alone even if nothing comes any more. What that is has to be certain: rows count as they were in this frame or, by as
// much as this frame's are cheaper, in the frames before; for those that the device never rendered a part of the mean
// is certain, and `come_share` of the time that rows which have come have saved.
double time_to_spare(const Client& c, double come_share) {
  auto is_measured = [](const RowModel& row) { return is_known(row.device_ns) && !row.guessed; };
  double seen = 0, seen_before = 0, others = 0, come = 0, unknown = 0;
  for (std::uint32_t r = 0; r < c.model.rows.count; ++r) {
    const RowModel& row = c.model.rows[r];
    if (!is_measured(row)) {
      if (!(row.device_ns_seen > 0)) ++unknown;
      continue;
    }
    double before = static_cast<double>(row.device_ns.value);
    if (row.device_ns_seen > 0)
      seen += static_cast<double>(row.device_ns_seen), seen_before += before;
    else
      others += before, come += c.merge.rows[r].state == RowState::server ? before : 0;
  }
  // Rows that were rendered at once have their mean: by a few of them a frame only seems to be dearer than the last.
  double change = seen_before > 0 ? std::min(1.0, seen / seen_before) : 1;
  double alone = std::max(c.device_ns, std::min(c.device_ns + change * others, seen_before + others));
  alone += kCertainPart * unknown * device_pixel_ns(c) * c.settings.width;
  double idle = static_cast<double>(client_now_ns(c) - c.begin_ns) - c.device_ns;
  return kWaitShare * alone + come_share * change * come - idle;
}

// What the rows that are not done would take the device: as this frame's and as those before, whichever is more.
double rows_left_ns(const Client& c) {
  double known = 0, count = c.merge.rows.count - c.merge.row_count_done;
  for (std::uint32_t r = 0; r < c.model.rows.count; ++r)
    if (c.merge.rows[r].state == RowState::missing) known += static_cast<double>(c.model.rows[r].device_ns.value);
  return std::max(known, device_pixel_ns(c) * c.settings.width * count);
}

// Whether the servers' rows are due before the device could render one, or late by less than that takes; and should
// none of them come, it is still done about when it would be alone.
bool is_worth_waiting(const Client& c) {
  double prepare = static_cast<double>(c.prepare_ns), due = c.share.predicted_ns - prepare;
  double elapsed = static_cast<double>(client_now_ns(c) - c.begin_ns), row = device_pixel_ns(c) * c.settings.width;
  if (!c.joined || elapsed + row <= due || elapsed >= std::max(kLateFactor * due, due + row)) return false;
  bool any_guessed = std::any_of(c.model.rows.begin(), c.model.rows.end(), [](const RowModel& r) { return r.guessed; });
  double latest = kLateFactor * (c.share.local_ns - prepare);
  return elapsed + rows_left_ns(c) <= latest && (any_guessed || time_to_spare(c, kCertainPart) > 0);
}

// Rows that the device may render without a look at the link: while somebody is there to look for, not for long.
std::uint32_t rows_between_looks(const Client& c) {
  bool any = false;
  for (std::uint32_t i = 0; i < c.server_count; ++i) any = any || c.servers[i].phase != ServerPhase::waiting;
  double row_ns = device_pixel_ns(c) * c.settings.width, look_ns = kLookNs;
  if (c.joined && is_watched(c))
    look_ns = std::min(look_ns, (c.share.predicted_ns - static_cast<double>(c.prepare_ns)) / kLooksWatched);
  look_ns = std::min(look_ns, work_ns_max(c));
  if (!any) return c.settings.height;
  // By this frame's rows so far, and by those of the frames before: what follows the sky costs more.
  std::uint32_t count = 0;
  for (double ns = 0; ns < look_ns && c.merge.next_row + count < c.model.rows.count; ++count)
    ns += std::max(row_ns, static_cast<double>(c.model.rows[c.merge.next_row + count].device_ns.value));
  return std::max(1u, count);
}

// Takes what has come, after waiting `timeout_ns` at most for something.
void look_at_servers(Client* c, std::uint64_t timeout_ns) {
  platform::LinkWait waits[kServerCountMax];
  int wait_count = 0;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    const RemoteServer& s = c->servers[i];
    if (s.phase == ServerPhase::waiting) continue;
    if (s.more) timeout_ns = 0;
    bool connecting = s.phase == ServerPhase::connecting;
    waits[wait_count].stream = s.messages.stream;
    waits[wait_count].want_read = !connecting;
    waits[wait_count++].want_write = connecting || has_output(s.messages);
  }
  std::uint64_t begin = client_now_ns(*c);
  c->unwatched_ns = begin > c->looked_ns ? begin - c->looked_ns : 0;
  c->link->backend->poll(c->link, waits, wait_count, timeout_ns);
  std::uint64_t now = client_now_ns(*c);
  std::uint64_t since = std::max(c->looked_ns, c->begin_ns);
  c->arrivals.gap_ns_max = std::max(c->arrivals.gap_ns_max, now > since ? now - since : 0);
  c->looked_ns = now;
  for (std::uint32_t i = 0; i < c->server_count; ++i) advance_server(c, &c->servers[i]);
  let_join(c);
}

void cancel_rest(Client* c) {
  Message message;
  message.type = MessageType::cancel;
  message.cancel.frame = c->request.frame;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    if (!s->frame.open) continue;
    // None of its rows came in time: it takes at least that long to start.
    if (s->frame.rows_come == 0 && s->phase == ServerPhase::ready)
      observe_start(&c->model, i, static_cast<double>(client_now_ns(*c) - s->frame.asked_ns));
    s->frame.open = false;
    bool sent = send_message(&s->messages, message);
    sent ? flush_server(c, s) : lose_server(c, s, "it does not read what it is sent");
  }
}

}  // namespace

std::uint64_t client_now_ns(const Client& c) {
  return platform::link_clock_ns(&c.clock, c.link->backend->now_ns(c.link));
}

std::size_t client_need(const Settings& settings, WireFormat format, std::uint32_t server_count) {
  CodecShape shape = codec_shape(settings, format);
  std::size_t each = message_stream_need(in_bytes(shape), kOutBytes) + row_decoder_need(shape);
  return server_count * each + cost_model_need(settings.height, server_count) +
         split_need(settings.height, server_count) + merge_need(settings.height) + verifier_need(settings) +
         arena_need(std::size_t(settings.width) * settings.height * pixel_bytes(format));
}

Status make_client(const ClientOptions& options, const Settings& settings, const ContentHash& scene,
                   platform::Link* link, const platform::LinkAddress* servers, std::uint32_t server_count, Arena* arena,
                   Client* c) {
  CHECK_LE(server_count, kServerCountMax);
  *c = Client();
  c->options = options;
  c->settings = settings;
  c->scene = scene;
  c->link = link;
  c->server_count = server_count;
  CodecShape shape = codec_shape(settings, options.format);
  if (!codec_shape_valid(shape))
    return failure("pictures of %ux%u pixels cannot be shared: use a smaller --size", settings.width, settings.height);
  c->pixels = arena_array_zeroed<std::uint8_t>(
      arena, std::size_t(settings.width) * settings.height * pixel_bytes(options.format));
  c->merge = make_merge(settings.height, arena);
  RETURN_IF_ERROR(make_verifier(options.check_count, options.entropy, settings, arena, &c->verifier));
  c->model = make_cost_model(settings.width, settings.height, server_count, arena);
  c->workspace = make_split_workspace(settings.height, server_count, arena);
  c->model.cost_per_device_pixel = options.cost_per_device_pixel;
  c->model.cost_per_byte = options.cost_per_byte;
  c->split.server_count = server_count;
  for (std::uint32_t& boundary : c->split.boundary) boundary = settings.height;
  for (std::uint32_t i = 0; i < server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    s->address = servers[i];
    s->messages = make_message_stream(in_bytes(shape), kOutBytes, arena);
    s->timer = platform::link_timer(client_now_ns(*c), 0);
    c->model.servers[i].cost_per_megabyte = options.cost_per_megabyte;
    c->model.servers[i].chunk_rows = kChunkRowsMin;
    RETURN_IF_ERROR(make_row_decoder(shape, arena, &s->decoder));
  }
  return success();
}

void close_client(Client* c) {
  for (std::uint32_t i = 0; i < c->server_count; ++i) close_message_stream(&c->servers[i].messages);
}

void work_until(Client* c, std::uint64_t due_ns) {
  for (std::uint64_t now = client_now_ns(*c), before = 0; now < due_ns && now != before; now = client_now_ns(*c)) {
    before = now;  // still, where the clock has been set back meanwhile: the time is over all the same
    c->link->backend->poll(c->link, nullptr, 0, due_ns - now);
  }
}

void advance_client(Client* c, std::uint64_t timeout_ns) {
  look_at_servers(c, timeout_ns);
  // A while of doing nothing but waiting for the answers of the overture, within what a network may cost.
  while (timeout_ns == 0 && !c->complete) {
    std::uint64_t wanted = wait_wanted_ns(*c);
    if (wanted == 0) return;
    double left = time_to_spare(*c, 0);
    std::uint64_t begin = client_now_ns(*c);
    // What the servers in use have saved is not for others to waste.
    if (c->joined) left = std::min(left, kWaitShare * c->share.predicted_ns - static_cast<double>(c->waited_ns));
    if (left <= 0) return;
    look_at_servers(c, std::min(wanted, static_cast<std::uint64_t>(left) + 1));
    c->waited_ns += client_now_ns(*c) - begin;
  }
}

void accept_chunk(Client* c, RemoteServer* s, const RowChunk& chunk, std::uint32_t byte_count) {
  std::uint32_t begin = chunk.row_begin, end = begin + chunk.row_count, server = index_of(*c, s);
  s->frame.bytes += byte_count;
  s->frame.row_bytes += chunk.bytes.count;
  bool current = chunk.frame == c->request.frame && !c->complete;
  if (!current || begin < s->frame.row_begin || end > s->frame.row_end) return;
  s->frame.rows_come += chunk.row_count;
  s->frame.heard_ns = client_now_ns(*c);
  if (s->frame.rows_come >= s->frame.row_end - s->frame.row_begin) s->frame.open = false;
  if (s->phase == ServerPhase::probing) s->probe_ns_per_pixel = 1e-3 * chunk.pixel_ps;
  double render_ns = 1e-3 * chunk.pixel_ps * c->settings.width * chunk.row_count;
  s->frame.render_ns += render_ns;
  if (s->frame.first_ns == 0)
    s->frame.first_ns = s->frame.heard_ns;
  else
    s->frame.bytes_behind += byte_count, s->frame.render_behind_ns += render_ns;
  Arrivals* a = &c->arrivals;
  a->last_ns = client_now_ns(*c);
  if (a->first_ns == 0)
    a->first_ns = a->last_ns;
  else
    a->bytes += byte_count;
  observe_server_rows(&c->model, server, begin, end, render_ns, byte_count);
  if (!agrees_with_device(c, s, begin, end)) return;
  if (!c->options.has_scene) compare_with_others(c, s, begin, end);
  if (s->useful_ns == 0 || s->told) server_is_useful(c, s);
  // Rows that are done keep their pixels: a row's sender answers for it.
  std::size_t row_bytes = std::size_t(c->settings.width) * pixel_bytes(c->options.format);
  for (std::uint32_t row = begin; row < end; ++row)
    if (!is_done(c->merge.rows[row]))
      std::memcpy(shared_row(*c, row), picture_row(s->decoder->state, row), row_bytes);
  if (accept_rows(&c->merge, chunk.frame, begin, end, server) == 0) return;
  c->progress_ns = a->last_ns;
  mark_dirty(c, begin, end);
}

void begin_client_frame(Client* c, const Renderer& r, double seconds, std::uint64_t prepare_ns) {
  if (!c->complete) {
    cancel_rest(c);
    end_frame(&c->model);
  }
  FrameShare last = c->share;
  c->share = FrameShare();
  c->share.measured_ns = last.measured_ns;
  c->complete = c->joined = false;
  c->waited_ns = 0, c->device_ns = 0, c->device_rows = 0;
  c->device_row = DeviceRow();
  c->begin_ns = client_now_ns(*c);
  c->prepare_ns = prepare_ns;
  c->arrivals = Arrivals();
  FrameRequest* q = &c->request;
  ++q->frame;
  q->scene = c->scene, q->seconds = seconds;
  q->camera_stated = c->options.has_scene || r.camera_overridden;  // without the scene: it moves as it does there
  q->camera_index = static_cast<std::uint16_t>(r.camera_index);
  q->camera = r.camera;
  q->camera.node = kNone;
  q->settings = r.settings;
  q->exposure = r.exposure;
  q->dither = c->options.dither;
  q->format = c->options.format;
  begin_merge(&c->merge, q->frame);
  begin_checks(c);
  c->share.frame = q->frame;
  c->bytes_in_before = c->bytes_out_before = 0;
  bool any = false;
  measure_anew(c);
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    s->frame = ServerFrame();
    c->bytes_in_before += s->messages.bytes_in, c->bytes_out_before += s->messages.bytes_out;
    any = any || s->phase == ServerPhase::ready;
  }
  c->held = any && wants_quiet(*c);
  if (any && c->options.has_scene && !c->held) share_rows(c, 0);
  advance_client(c, 0);
}

bool take_device_rows(Client* c, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end) {
  if (!c->options.has_scene) return false;
  row_count_max = std::min(row_count_max, rows_between_looks(*c));
  std::uint32_t own_end = c->joined ? c->split.boundary[0] : c->settings.height;
  std::uint32_t next = c->merge.next_row;
  if (next < own_end) {
    row_count_max = std::min(row_count_max, own_end - next);
  } else {
    // Rows of servers that have not come, one at a time: they may be there any moment.
    bool awaited = false;
    for (std::uint32_t i = 0; i < c->server_count; ++i) awaited = awaited || c->servers[i].frame.open;
    if (awaited && (!c->options.device_goes_on || is_worth_waiting(*c))) return false;
    if (awaited) row_count_max = 1;
  }
  return take_rows(&c->merge, row_count_max, row_begin, row_end);
}

void finish_device_rows(Client* c, std::uint32_t row_begin, std::uint32_t row_end, std::uint64_t ns) {
  std::uint32_t count = row_end - row_begin;
  for (std::uint32_t row = row_begin; row < row_end; ++row)
    observe_device_row(&c->model, row, static_cast<double>(ns) / count);
  c->device_ns += static_cast<double>(ns), c->device_rows += count;
  finish_rows(&c->merge, row_begin, row_end);
  mark_dirty(c, row_begin, row_end);
}

void end_client_frame(Client* c) {
  CHECK(is_complete(c->merge));
  c->complete = true;
  FrameShare* share = &c->share;
  share->measured_ns = static_cast<double>(client_elapsed_ns(*c));
  share->device_rows = count_rows(c->merge, kDeviceRows);
  share->bytes_in = share->bytes_out = 0;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    share->server_rows[i] = count_rows(c->merge, i);
    share->row_begin[i] = c->servers[i].frame.row_begin, share->row_end[i] = c->servers[i].frame.row_end;
    share->server_bytes[i] = c->servers[i].frame.bytes;
    share->row_bytes += c->servers[i].frame.row_bytes;
    share->bytes_in += c->servers[i].messages.bytes_in, share->bytes_out += c->servers[i].messages.bytes_out;
  }
  auto since = [](std::uint64_t now, std::uint64_t before) { return now > before ? now - before : 0; };
  share->bytes_in = since(share->bytes_in, c->bytes_in_before);
  share->bytes_out = since(share->bytes_out, c->bytes_out_before);
  measure_link(c);
  if (!c->options.has_scene) learn_row_times(c);
  if (c->joined) ++c->frames_shared;
  cancel_rest(c);
  end_frame(&c->model);
}

bool is_settled(const Client& c) {
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    const RemoteServer& s = c.servers[i];
    if (s.phase == ServerPhase::ready || (s.phase == ServerPhase::waiting && s.told)) continue;
    return false;
  }
  return true;
}

bool take_shared_rows(Client* c, std::uint32_t* row_begin, std::uint32_t* row_end) {
  if (c->dirty_begin >= c->dirty_end) return false;
  *row_begin = c->dirty_begin, *row_end = c->dirty_end;
  c->dirty_begin = c->dirty_end = 0;
  return true;
}

}  // namespace pocketray
