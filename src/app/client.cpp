#include "app/client.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "app/client_parts.h"
#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::size_t kOutBytes = 1024;     // of requests that wait to be sent
constexpr std::size_t kInBytesMin = 20000;  // holds the ping that measures the bandwidth
constexpr double kWaitShare = 0.04;         // of a frame's time that the overture may wait: less than the 5 % that a
                                            // network may cost
constexpr double kGapsMin = 4;              // looks in which rows have to come for their time to mean something
constexpr double kLinkBound = 1.15;         // times that rows take on the link beyond what they take on the servers
constexpr double kLateFactor = 1.03;        // of a frame's predicted time, after which nobody waits for rows
constexpr double kLookNs = 20e6;            // between two looks at the link: a frame that a screen shows
constexpr double kLooksWatched = 16;  // in a frame that is watched. It costs the device's packets some of their speed:
constexpr std::uint64_t kWatchedFirst = 4, kWatchedEvery = 16;  // so only the first of these and each of those is
constexpr std::uint32_t kProbeRowsMax = 2 * kChunkRows, kProbeDivisor = 15;  // of the rows: 16 of 240
// Nanoseconds a byte beyond which fewer bytes are worth more of the server's time. Measured (codec_frames_test): level
// 1 takes 400 ns and saves 1.5 bytes a pixel of RGB565, level 6 takes another 300 and saves 0.06.
constexpr double kDeflateNsPerByte = 250, kDeflateMoreNsPerByte = 5000;

CodecShape codec_shape(const Settings& settings, WireFormat format) {
  return {settings.width, settings.height, std::min(kChunkRows, settings.height), format};
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

std::uint32_t index_of(const Client& c, const RemoteServer* s) { return static_cast<std::uint32_t>(s - c.servers); }

// What a pixel costs the device, by this frame or those before; 0: not known.
double device_pixel_ns(const Client& c) {
  double width = c.settings.width;
  if (c.device_rows > 0) return c.device_ns / (width * c.device_rows);
  double sum = 0;
  std::uint32_t count = 0;
  for (const RowModel& row : c.model.rows)
    if (is_known(row.device_ns)) sum += static_cast<double>(row.device_ns.value), ++count;
  return count ? sum / (width * count) : 0;
}

// Asks a server for rows; those at the end that are done are left out.
void ask_for_rows(Client* c, RemoteServer* s, std::uint32_t row_begin, std::uint32_t row_end) {
  auto is_done = [&](std::uint32_t row) {
    return c->merge.rows[row].state == RowState::device || c->merge.rows[row].state == RowState::server;
  };
  while (row_end > row_begin && is_done(row_end - 1)) --row_end;
  if (row_begin >= row_end) return;
  Message message;
  message.type = MessageType::frame_request;
  message.frame_request = c->request;
  message.frame_request.row_begin = static_cast<std::uint16_t>(row_begin);
  message.frame_request.row_end = static_cast<std::uint16_t>(row_end);
  message.frame_request.chunk_rows = static_cast<std::uint16_t>(std::min(kChunkRows, c->settings.height));
  message.frame_request.deflate_level = deflate_level(s->ns_per_byte);
  if (!send_message(&s->messages, message)) return lose_server(c, s, "it does not read what it is sent");
  std::uint64_t bytes = s->frame.bytes, row_bytes = s->frame.row_bytes;
  s->frame = {row_begin, row_end, 0, client_now_ns(*c), bytes, row_bytes, 0, true};
  if (!s->unanswered) s->timer = platform::link_timer(s->frame.asked_ns, c->options.silence_timeout_ns);
  s->unanswered = true;
  flush_server(c, s);
}

// Fixed share: the device's rows as told, the others among the servers by their speed.
Split split_by_share(const Client& c, const SplitProblem& problem) {
  Split split;
  split.server_count = c.server_count;
  double rows = problem.row_count, speed_sum = 0, so_far = 0;
  auto speed_of = [&](std::uint32_t i) {
    return problem.servers[i].usable ? 1 / static_cast<double>(c.model.servers[i].speed.value) : 0;
  };
  for (std::uint32_t i = 0; i < c.server_count; ++i) speed_sum += speed_of(i);
  double device_rows = speed_sum > 0 ? std::floor(rows * c.options.device_share + 0.5) : rows;
  for (std::uint32_t i = 0; i <= c.server_count; ++i) {
    double share = speed_sum > 0 ? so_far / speed_sum : 0;
    split.boundary[i] = static_cast<std::uint32_t>(std::floor(device_rows + (rows - device_rows) * share + 0.5));
    if (i < c.server_count) so_far += speed_of(i);
  }
  split.boundary[c.server_count] = problem.row_count;
  predict_split(problem, &split);
  return split;
}

// The split for the frame, of which `elapsed_ns` have passed, and the requests that follow.
void share_rows(Client* c, std::uint64_t elapsed_ns) {
  SplitProblem problem = make_problem(&c->model, c->options.wish);
  for (std::uint32_t i = 0; i < c->server_count; ++i) problem.servers[i].start_ns += elapsed_ns;
  if (c->options.device_share >= 0)
    c->split = split_by_share(*c, problem);
  else
    c->split = elapsed_ns > 0 ? find_split(problem, &c->workspace) : next_split(problem, c->split, &c->workspace);
  c->share.predicted_ns = static_cast<double>(c->split.time_ns);
  Split alone;
  alone.server_count = c->server_count;
  for (std::uint32_t& boundary : alone.boundary) boundary = problem.row_count;
  predict_split(problem, &alone);
  c->share.local_ns = static_cast<double>(alone.time_ns);
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    s->ns_per_byte = static_cast<double>(c->model.servers[i].ns_per_byte.value);
    if (s->phase == ServerPhase::ready) ask_for_rows(c, s, c->split.boundary[i], c->split.boundary[i + 1]);
  }
  c->joined = true;
}

// Servers whose overture has come to their first rows get them from the bottom.
void probe_servers(Client* c) {
  std::uint32_t bottom = c->settings.height;
  std::uint32_t rows = std::max(1u, std::min(kProbeRowsMax, bottom / kProbeDivisor));
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    if (s->phase != ServerPhase::probing || s->frame.open || s->frame.rows_come > 0) continue;
    while (bottom > 0 && c->merge.rows[bottom - 1].state != RowState::missing) --bottom;
    if (bottom < c->merge.next_row + 2 * rows) return;  // too late for this frame
    ask_for_rows(c, s, bottom - rows, bottom);
    bottom -= rows;
  }
}

void finish_probe(Client* c, RemoteServer* s) {
  double device = device_pixel_ns(*c);
  if (device == 0 || s->frame.open || s->frame.rows_come == 0) return;
  double pixels = static_cast<double>(s->frame.rows_come) * c->settings.width;
  double bytes_per_pixel = std::max(1e-3, static_cast<double>(s->frame.bytes) / pixels);
  PixelTimes times = {device, s->probe_ns_per_pixel, s->ns_per_byte * bytes_per_pixel};
  observe_overture(&c->model, index_of(*c, s), times, bytes_per_pixel, s->round_trip_ns);
  // What the radio that all servers share gives to the best of them when it is alone.
  Smoothed* link = &c->model.link_ns_per_byte;
  if (!is_known(*link) || s->ns_per_byte < static_cast<double>(link->value)) {
    *link = Smoothed();
    smooth(link, s->ns_per_byte);
  }
  server_is_ready(c, s);
  c->frames_shared = 0;
}

// Servers that have become ready within the frame get their share of what is left, once nobody is worth waiting for.
void let_join(Client* c) {
  if (c->complete) return;
  bool any = false;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    if (c->servers[i].phase == ServerPhase::probing) finish_probe(c, &c->servers[i]);
    any = any || c->servers[i].phase == ServerPhase::ready;
  }
  probe_servers(c);
  if (c->joined || !any || (!is_settled(*c) && c->merge.next_row < c->settings.height / 4)) return;
  share_rows(c, client_now_ns(*c) - c->begin_ns);
}

// What the frame's rows tell of the link. They come as fast as the slower of servers and link allows: where the servers
// were faster, or the link did better than it was thought to be, that is its speed.
void measure_link(Client* c) {
  const Arrivals& a = c->arrivals;
  double ns = static_cast<double>(a.last_ns - a.first_ns), bytes = static_cast<double>(a.bytes);
  if (bytes == 0 || ns < kGapsMin * static_cast<double>(a.gap_ns_max)) return;
  double rate = 0;  // bytes per nanosecond that the servers make
  std::uint32_t count = 0, last = 0;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    const ServerFrame& f = c->servers[i].frame;
    if (f.rows_come == 0 || c->servers[i].phase != ServerPhase::ready) continue;
    if (f.render_ns > 0) rate += static_cast<double>(f.bytes) / f.render_ns;
    ++count, last = i;
  }
  Smoothed* link = &c->model.link_ns_per_byte;
  double before = is_known(*link) ? static_cast<double>(link->value) : 0;
  bool link_bound = rate > 0 && ns / bytes * rate > kLinkBound, better = ns / bytes < before;
  if (count == 0 || !(link_bound || better)) return;
  if (count == 1) observe_transfer(&c->model, last, bytes, ns);
  smooth(link, ns / bytes);
  if (count > 1 && before > 0)
    for (std::uint32_t i = 0; i < c->server_count; ++i)
      scale(&c->model.servers[i].ns_per_byte, static_cast<double>(link->value) / before);
}

// Frames in which the device looks often, so that it sees when rows come: the first ones with a server, and a few
// later.
bool is_watched(const Client& c) { return c.frames_shared < kWatchedFirst || c.frames_shared % kWatchedEvery == 0; }

// Whether the servers' rows are due before the device could render one, or late by less than that takes.
bool is_worth_waiting(const Client& c) {
  double elapsed = static_cast<double>(client_now_ns(c) - c.begin_ns), due = c.share.predicted_ns;
  double row = device_pixel_ns(c) * c.settings.width;
  return c.joined && elapsed + row > due && elapsed < std::max(kLateFactor * due, due + row);
}

// Rows that the device may render without a look at the link: while somebody is there to look for, not for long.
std::uint32_t rows_between_looks(const Client& c) {
  bool any = false;
  for (std::uint32_t i = 0; i < c.server_count; ++i) any = any || c.servers[i].phase != ServerPhase::waiting;
  double row_ns = device_pixel_ns(c) * c.settings.width, look_ns = kLookNs;
  if (c.joined && is_watched(c)) look_ns = std::min(look_ns, c.share.predicted_ns / kLooksWatched);
  if (!any || !(row_ns * c.settings.height > look_ns)) return c.settings.height;
  return row_ns < look_ns ? static_cast<std::uint32_t>(look_ns / row_ns) : 1;
}

// Takes what has come, after waiting `timeout_ns` at most for something.
void look_at_servers(Client* c, std::uint64_t timeout_ns) {
  platform::LinkWait waits[kServerCountMax];
  int wait_count = 0;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    const RemoteServer& s = c->servers[i];
    if (s.phase == ServerPhase::waiting) continue;
    bool connecting = s.phase == ServerPhase::connecting;
    waits[wait_count].stream = s.messages.stream;
    waits[wait_count].want_read = !connecting;
    waits[wait_count++].want_write = connecting || has_output(s.messages);
  }
  std::uint64_t begin = client_now_ns(*c);
  c->unwatched_ns = begin > c->looked_ns ? begin - c->looked_ns : 0;
  c->link->backend->poll(c->link, waits, wait_count, timeout_ns);
  std::uint64_t now = client_now_ns(*c);
  c->arrivals.gap_ns_max = std::max(c->arrivals.gap_ns_max, now > c->looked_ns ? now - c->looked_ns : 0);
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

std::uint8_t deflate_level(double ns_per_byte) {
  return ns_per_byte < kDeflateNsPerByte ? 0 : ns_per_byte < kDeflateMoreNsPerByte ? 1 : 6;
}

std::size_t client_need(const Settings& settings, WireFormat format, std::uint32_t server_count) {
  CodecShape shape = codec_shape(settings, format);
  std::size_t each = message_stream_need(in_bytes(shape), kOutBytes) + row_decoder_need(shape);
  return server_count * each + cost_model_need(settings.height, server_count) +
         split_need(settings.height, server_count) + merge_need(settings.height) +
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
    c->model.servers[i].chunk_rows = kChunkRows;
    RETURN_IF_ERROR(make_row_decoder(shape, arena, &s->decoder));
  }
  return success();
}

void close_client(Client* c) {
  for (std::uint32_t i = 0; i < c->server_count; ++i) close_message_stream(&c->servers[i].messages);
}

void work_until(Client* c, std::uint64_t due_ns) {
  for (std::uint64_t now = client_now_ns(*c); now < due_ns; now = client_now_ns(*c))
    c->link->backend->poll(c->link, nullptr, 0, due_ns - now);
}

void advance_client(Client* c, std::uint64_t timeout_ns) {
  look_at_servers(c, timeout_ns);
  // A while of doing nothing but waiting for the answers of the overture, within what a network may cost.
  while (timeout_ns == 0 && !c->complete) {
    double elapsed = static_cast<double>(client_now_ns(*c) - c->begin_ns);
    double alone = device_pixel_ns(*c) * c->settings.width * c->settings.height;
    double left = kWaitShare * std::max({elapsed, c->share.measured_ns, alone}) - static_cast<double>(c->waited_ns);
    std::uint64_t wanted = wait_wanted_ns(*c), begin = client_now_ns(*c);
    if (wanted == 0 || left <= 0) return;
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
  if (s->frame.rows_come >= s->frame.row_end - s->frame.row_begin) s->frame.open = false;
  if (s->phase == ServerPhase::probing) s->probe_ns_per_pixel = 1e-3 * chunk.pixel_ps;
  double render_ns = 1e-3 * chunk.pixel_ps * c->settings.width * chunk.row_count;
  s->frame.render_ns += render_ns;
  Arrivals* a = &c->arrivals;
  a->last_ns = client_now_ns(*c);
  if (a->first_ns == 0)
    a->first_ns = a->last_ns;
  else
    a->bytes += byte_count;
  observe_server_rows(&c->model, server, begin, end, render_ns, byte_count);
  if (accept_rows(&c->merge, chunk.frame, begin, end, server) == 0) return;
  std::size_t row_bytes = std::size_t(c->settings.width) * pixel_bytes(c->options.format);
  std::memcpy(shared_row(*c, begin), picture_row(s->decoder->state, begin), row_bytes * chunk.row_count);
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
  c->begin_ns = c->looked_ns = client_now_ns(*c);
  c->arrivals = Arrivals();
  observe_device_start(&c->model, static_cast<double>(prepare_ns));
  FrameRequest* q = &c->request;
  ++q->frame;
  q->scene = c->scene, q->seconds = seconds;
  q->camera_stated = true;
  q->camera_index = static_cast<std::uint16_t>(r.camera_index);
  q->camera = r.camera;
  q->camera.node = kNone;
  q->settings = r.settings;
  q->exposure = r.exposure;
  q->dither = c->options.dither;
  q->format = c->options.format;
  begin_merge(&c->merge, q->frame);
  c->share.frame = q->frame;
  c->bytes_in_before = c->bytes_out_before = 0;
  bool any = false;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    s->frame = ServerFrame();
    c->bytes_in_before += s->messages.bytes_in, c->bytes_out_before += s->messages.bytes_out;
    any = any || s->phase == ServerPhase::ready;
  }
  if (any) share_rows(c, 0);
  advance_client(c, 0);
}

bool take_device_rows(Client* c, std::uint32_t row_count_max, std::uint32_t* row_begin, std::uint32_t* row_end) {
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
  share->measured_ns = static_cast<double>(client_now_ns(*c) - c->begin_ns);
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
