// What a client asks of whom: the split of a frame, servers that join it, what a frame tells of the link.
#include <algorithm>
#include <cmath>

#include "remote/client/parts.h"

namespace pocketray {
namespace {

constexpr double kGapsMin = 4;       // looks in which rows have to come for their time to mean something
constexpr double kDisproved = 1.25;  // times that a link is faster than it was thought to be, if that is no noise
constexpr double kLinkBound = 1.15;  // times that rows take on the link beyond what they take on the servers
constexpr std::uint32_t kProbeRowsMax = 16, kProbeDivisor = 15;  // of the rows: 16 of 240
constexpr double kGrowthMin = 4, kGrowthMax = 32;                // of chunks, in 16ths, where they grow
// Nanoseconds a byte beyond which fewer bytes are worth more of the server's time. Measured (codec_frames_test): level
// 1 takes 400 ns and saves 1.5 bytes a pixel of RGB565, level 6 takes another 300 and saves 0.06.
constexpr double kDeflateNsPerByte = 250, kDeflateMoreNsPerByte = 5000;

// How far chunks may grow from one to the next without keeping the slower of rendering and sending from its work: while
// one chunk is in the slower, the next passes the faster. 0 where neither is much slower. Stays as it is within a
// factor of two: rows compress better where they are cut as in the frame before.
std::uint8_t chunk_growth(const SplitProblem& p, std::uint32_t server, const Split& split, std::uint8_t before) {
  const ServerTables& t = p.servers[server];
  std::uint32_t begin = split.boundary[server], end = split.boundary[server + 1];
  if (begin == end) return before;
  double render = static_cast<double>(t.render_ns[end] - t.render_ns[begin]);
  double send = static_cast<double>(
      std::max(t.transfer_ns[end] - t.transfer_ns[begin], p.link_ns[p.row_count] - p.link_ns[split.boundary[0]]));
  double slower = std::max(render, send), faster = std::min(render, send);
  double growth = faster * kGrowthMax < 16 * (slower - faster) ? kGrowthMax : 16 * (slower - faster) / faster;
  if (growth <= 2 * before && 2 * growth >= before) return before;
  return growth < kGrowthMin ? std::uint8_t(0) : static_cast<std::uint8_t>(growth);
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
  observe_own_link(&c->model, s->ns_per_byte);
  server_is_ready(c, s);
  c->frames_shared = 0;
}

}  // namespace

std::uint8_t deflate_level(double ns_per_byte) {
  return ns_per_byte < kDeflateNsPerByte ? 0 : ns_per_byte < kDeflateMoreNsPerByte ? 1 : 6;
}

void ask_for_rows(Client* c, RemoteServer* s, std::uint32_t row_begin, std::uint32_t row_end) {
  auto is_done = [&](std::uint32_t row) {
    return c->merge.rows[row].state == RowState::device || c->merge.rows[row].state == RowState::server;
  };
  while (row_end > row_begin && is_done(row_end - 1)) --row_end;
  if (row_begin < row_end) request_rows(c, s, row_begin, row_end);
}

void request_rows(Client* c, RemoteServer* s, std::uint32_t row_begin, std::uint32_t row_end) {
  Message message;
  message.frame_request = c->request;
  message.frame_request.row_begin = static_cast<std::uint16_t>(row_begin);
  message.frame_request.row_end = static_cast<std::uint16_t>(row_end);
  std::uint32_t chunk_rows = s->chunk_growth > 0 ? kChunkRowsMin : kChunkRowsEven;
  c->model.servers[index_of(*c, s)].chunk_rows = chunk_rows;
  message.frame_request.chunk_rows = static_cast<std::uint16_t>(std::min(chunk_rows, c->settings.height));
  message.frame_request.chunk_rows_max = static_cast<std::uint16_t>(std::min(kChunkRowsMax, c->settings.height));
  message.frame_request.chunk_growth = s->chunk_growth;
  message.frame_request.deflate_level = deflate_level(s->ns_per_byte);
  bool like_the_last = s->asked.frame > 0 && is_change(message.frame_request, s->asked);
  message.type = like_the_last ? MessageType::frame_change : MessageType::frame_request;
  if (s->asked.frame > 0) s->late_rows += s->due_end - s->asked.row_begin;
  s->asked = message.frame_request;
  s->due_end = row_end;
  if (!send_message(&s->messages, message)) return lose_server(c, s, "it does not read what it is sent");
  std::uint64_t bytes = s->frame.bytes, row_bytes = s->frame.row_bytes;
  s->frame = {row_begin, row_end, 0, client_now_ns(*c), bytes, row_bytes, 0, true};
  if (!s->unanswered) s->timer = platform::link_timer(s->frame.asked_ns, silence_limit_ns(*c, *s));
  s->unanswered = true;
  flush_server(c, s);
}

double device_pixel_ns(const Client& c) {
  double width = c.settings.width;
  if (c.device_rows > 0) return c.device_ns / (width * c.device_rows);
  double sum = 0;
  std::uint32_t count = 0;
  for (const RowModel& row : c.model.rows)
    if (is_known(row.device_ns)) sum += static_cast<double>(row.device_ns.value), ++count;
  return count ? sum / (width * count) : 0;
}

void share_rows(Client* c, std::uint64_t elapsed_ns) {
  SplitProblem problem = make_problem(&c->model, c->options.wish);
  // Times count from the frame's begin: the device could render from then on, servers begin when they are asked.
  auto from_now = [&](std::uint64_t* start_ns) { *start_ns = std::min(kRowTableMax, *start_ns + elapsed_ns); };
  from_now(&problem.link_start_ns);
  for (std::uint32_t i = 0; i < c->server_count; ++i) from_now(&problem.servers[i].start_ns);
  if (c->options.device_share >= 0)
    c->split = split_by_share(*c, problem);
  else
    c->split = elapsed_ns > 0 ? find_split(problem, &c->workspace) : next_split(problem, c->split, &c->workspace);
  c->share.predicted_ns = static_cast<double>(c->split.time_ns + c->prepare_ns);
  Split alone;
  alone.server_count = c->server_count;
  for (std::uint32_t& boundary : alone.boundary) boundary = problem.row_count;
  predict_split(problem, &alone);
  c->share.local_ns = static_cast<double>(alone.time_ns + c->prepare_ns);
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    if (s->phase != ServerPhase::ready) continue;  // the others' figure is their overture's
    s->ns_per_byte = static_cast<double>(c->model.servers[i].ns_per_byte.value);
    s->chunk_growth = chunk_growth(problem, i, c->split, s->chunk_growth);
    ask_for_rows(c, s, c->split.boundary[i], c->split.boundary[i + 1]);
  }
  c->joined = true;
}

void let_join(Client* c) {
  if (!c->options.has_scene) return ask_idle_servers(c);
  if (c->complete) return;
  bool any = false;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    if (c->servers[i].phase == ServerPhase::probing) finish_probe(c, &c->servers[i]);
    any = any || c->servers[i].phase == ServerPhase::ready;
  }
  probe_servers(c);
  if (c->joined || !any) return;
  if (c->held ? wants_quiet(*c) : !is_settled(*c) && c->merge.next_row < c->settings.height / 4) return;
  share_rows(c, client_now_ns(*c) - c->begin_ns);
}

namespace {

// A server's bytes came no slower than its link allows: where they came faster than it was thought to be, that is
// wrong.
void measure_own_links(Client* c) {
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    const ServerFrame& f = c->servers[i].frame;
    double ns = static_cast<double>(f.heard_ns - f.first_ns), bytes = static_cast<double>(f.bytes_behind);
    if (bytes == 0 || ns < kGapsMin * static_cast<double>(c->arrivals.gap_ns_max)) continue;
    if (ns < bytes * static_cast<double>(c->model.servers[i].ns_per_byte.value))
      observe_transfer(&c->model, i, bytes, ns);
  }
}

// All of a server's rows came within the frame, however seldom the device looked: its link is no slower than that. How
// fast it is, is to be measured.
void bound_own_links(Client* c) {
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    RemoteServer* s = &c->servers[i];
    Smoothed* ns_per_byte = &c->model.servers[i].ns_per_byte;
    double ns = static_cast<double>(s->frame.heard_ns - c->begin_ns);
    double bytes = static_cast<double>(s->frame.bytes_behind);
    bool disproved = kDisproved * ns < bytes * static_cast<double>(ns_per_byte->value);
    if (s->phase != ServerPhase::ready || bytes == 0 || !disproved) continue;
    *ns_per_byte = Smoothed();
    smooth(ns_per_byte, ns / bytes);
    observe_own_link(&c->model, ns / bytes);
    s->scaled = kUnsound;
  }
}

// Bytes per nanosecond that a server makes of the rows behind its first chunk: the arrivals begin with that one, and
// its rows may be far cheaper than theirs.
double rate_of(const ServerFrame& f) {
  if (f.render_behind_ns > 0) return static_cast<double>(f.bytes_behind) / f.render_behind_ns;
  return f.render_ns > 0 ? static_cast<double>(f.bytes) / f.render_ns : 0;
}

}  // namespace

void measure_link(Client* c) {
  bound_own_links(c);
  const Arrivals& a = c->arrivals;
  double ns = static_cast<double>(a.last_ns - a.first_ns), bytes = static_cast<double>(a.bytes);
  if (bytes == 0 || ns < kGapsMin * static_cast<double>(a.gap_ns_max)) return;
  measure_own_links(c);
  double rate = 0;  // bytes per nanosecond that the servers make
  std::uint32_t count = 0, last = 0;
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    const ServerFrame& f = c->servers[i].frame;
    if (f.rows_come == 0 || c->servers[i].phase != ServerPhase::ready) continue;
    rate += rate_of(f);
    ++count, last = i;
  }
  Smoothed* link = &c->model.link_ns_per_byte;
  double before = is_known(*link) ? static_cast<double>(link->value) : 0;
  bool link_bound = rate > 0 && ns / bytes * rate > kLinkBound, better = ns / bytes < before;
  if (count == 0 || !(link_bound || better)) return;
  smooth(link, ns / bytes);
  if (count == 1 && link_bound) observe_transfer(&c->model, last, bytes, ns);
  if (!(before > 0)) return;
  // What has become of each by itself is measured when it has become doubtful.
  double factor = static_cast<double>(link->value) / before;
  if (count == 1) {
    if (link_bound) c->servers[last].scaled *= factor;
    return;
  }
  for (std::uint32_t i = 0; i < c->server_count; ++i) {
    scale(&c->model.servers[i].ns_per_byte, factor);
    c->servers[i].scaled *= factor;
  }
}

}  // namespace pocketray
