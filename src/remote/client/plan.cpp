// Plans requests: the split of a frame, servers that join it, the link measured by a frame.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "remote/client/parts.h"
#include "split/row_order.h"

namespace pocketray {
namespace {

// Measured by `make split-table` unless stated otherwise: with lower values, noise of single frames moves the split.
constexpr double kGapsMin = 4;         // polls in which rows must arrive for their time to count
constexpr double kDisproved = 1.25;    // a link faster than estimated by more than this is not noise
constexpr double kLinkBound = 1.15;    // rows that take this much longer than on the servers are limited by the link
constexpr double kLinkLimited = 0.97;  // of a frame's time: above this, the link limits the split
// Time to send all rows relative to the time to trace a server's: below this, the link keeps up with several servers.
// At .9, some splits are off by 7 %.
constexpr double kLightLink = 0.7;
constexpr double kRaise = 0.5;  // of a start's distance from its lower bound, since jitter raises it in single frames
constexpr double kLinkFaster = 0.95, kLinkKept = 1.02;  // chosen: a failed trial costs a twentieth of a frame
constexpr std::uint64_t kLinkRestMax = 64;  // frames without such trials; chosen: they then cost a thousandth
constexpr std::uint32_t kProbeRowsMax = 16, kProbeDivisor = 15;  // of the rows: 16 of 240
static_assert(kOrderRunsMax <= kRunCountMax && kRunRowsMax <= UINT8_MAX, "a request can express every order");
// Nanoseconds per byte above which coding rows pays, until the device knows its own. Measured
// (tests/bench/device/codec_cost.py), per pixel of RGB565: coding saves 1.9 bytes, and decoding takes a Cortex-A7 75 ns
// and an ARM926 250 ns, so it pays above 40 and 130 ns per byte.
constexpr double kCodeNsPerByte = 60;
constexpr double kCodeMargin = 1.25;  // chosen: exceeds the variation of decoding times between frames

// Sets the order of a request's rows in which the server's tracing and sending overlap best.
void set_order(const SplitProblem& p, std::uint32_t server, FrameRequest* request) {
  CHECK_LT(server, p.server_count);
  const ServerTables& t = p.servers[server];
  const std::uint32_t begin = request->row_begin, end = request->row_end;
  if (!t.usable) return;
  const double own = static_cast<double>(t.transfer_ns[end] - t.transfer_ns[begin]);
  // All servers' rows may share a link.
  const double link = static_cast<double>(p.link_ns[p.row_count] - p.link_ns[begin]);
  RowOrder order;
  order_rows(t, begin, end, link > own && own > 0 ? link / own : 1, &order);
  request->run_count = static_cast<std::uint8_t>(order.run_count);
  std::uint8_t places[kOrderRunsMax];  // in the order from the top
  for (std::uint32_t i = 0; i < order.run_count; ++i) places[i] = static_cast<std::uint8_t>(i);
  std::sort(places, places + order.run_count,
            [&](std::uint8_t a, std::uint8_t b) { return order.runs[a].begin < order.runs[b].begin; });
  for (std::uint32_t i = 0; i < order.run_count; ++i) {
    const RowRange run = order.runs[places[i]];
    request->runs[i] = {static_cast<std::uint8_t>(run.end - run.begin), places[i]};
  }
}

// Fixed share: the device's rows as given, the others divided among the servers by speed.
Split split_by_share(const Client& client, const SplitProblem& problem) {
  CHECK(client.options.device_share >= 0 && client.options.device_share <= 1);
  Split split;
  split.server_count = client.server_count;
  double rows = problem.row_count, speed_sum = 0, so_far = 0;
  auto speed_of = [&](std::uint32_t i) {
    return problem.servers[i].usable ? 1 / server_slowness(client.plan.model.servers[i]) : 0;
  };
  for (std::uint32_t i = 0; i < client.server_count; ++i) speed_sum += speed_of(i);
  double device_rows = speed_sum > 0 ? std::floor(rows * client.options.device_share + 0.5) : rows;
  for (std::uint32_t i = 0; i <= client.server_count; ++i) {
    double share = speed_sum > 0 ? so_far / speed_sum : 0;
    split.boundary[i] = static_cast<std::uint32_t>(std::floor(device_rows + (rows - device_rows) * share + 0.5));
    if (i < client.server_count) so_far += speed_of(i);
  }
  split.boundary[client.server_count] = problem.row_count;
  predict_split(problem, &split);
  return split;
}

// Requests the first rows, from the bottom, of servers whose overture has got that far.
void probe_servers(Client* client) {
  std::uint32_t bottom = client->settings.height;
  std::uint32_t rows = std::max(1u, std::min(kProbeRowsMax, bottom / kProbeDivisor));
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (server->overture.phase != ServerPhase::probing || server->rows.frame.open || server->rows.frame.rows_come > 0)
      continue;
    while (bottom > 0 && client->picture.merge.rows[bottom - 1].state != RowState::missing) --bottom;
    if (bottom < client->picture.merge.next_row + 2 * rows) return;  // too late for this frame
    ask_for_rows(client, server, bottom - rows, bottom);
    bottom -= rows;
  }
}

void finish_probe(Client* client, RemoteServer* server) {
  double device = device_pixel_ns(*client);
  if (device == 0 || server->rows.frame.open || server->rows.frame.rows_come == 0) return;
  double pixels = static_cast<double>(server->rows.frame.rows_come) * client->settings.width;
  double bytes_per_pixel = std::max(1e-3, static_cast<double>(server->rows.frame.bytes) / pixels);
  PixelTimes times = {device, server->overture.probe_ns_per_pixel, server->link.ns_per_byte * bytes_per_pixel};
  observe_overture(&client->plan.model, index_of(*client, server), times, bytes_per_pixel, server->link.round_trip_ns);
  observe_own_link(&client->plan.model, server->link.ns_per_byte);
  server_is_ready(client, server);
  client->plan.frames_with_servers = 0;
}

}  // namespace

double code_threshold(const Client& client, const RemoteServer& server) {
  const bool known = is_known(client.plan.decode_ns) && is_known(client.plan.code_saves);
  if (!known) return kCodeNsPerByte;
  const double pays =
      static_cast<double>(client.plan.decode_ns.value) / static_cast<double>(client.plan.code_saves.value);
  return server.rows.asked.coding == RowCoding::raw ? pays * kCodeMargin : pays / kCodeMargin;
}

RowCoding row_coding(double ns_per_byte, double threshold, bool near_lossless) {
  if (ns_per_byte < threshold) return RowCoding::raw;
  return near_lossless ? RowCoding::near_lossless : RowCoding::lossless;
}

void ask_for_rows(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end,
                  const SplitProblem* problem) {
  CHECK(row_begin <= row_end && row_end <= client->settings.height);
  auto is_done = [&](std::uint32_t row) {
    return client->picture.merge.rows[row].state == RowState::device ||
           client->picture.merge.rows[row].state == RowState::server;
  };
  while (row_end > row_begin && is_done(row_end - 1)) --row_end;
  if (row_begin < row_end) request_rows(client, server, row_begin, row_end, problem);
}

void request_rows(Client* client, RemoteServer* server, std::uint32_t row_begin, std::uint32_t row_end,
                  const SplitProblem* problem) {
  Message message;
  CHECK(row_begin < row_end && row_end <= client->settings.height);
  CHECK_GE(server->messages.stream, 0);
  message.frame_request = client->frame.request;
  message.frame_request.row_begin = static_cast<std::uint16_t>(row_begin);
  message.frame_request.row_end = static_cast<std::uint16_t>(row_end);
  const std::uint32_t index = index_of(*client, server);
  if (problem) set_order(*problem, index, &message.frame_request);
  const bool ordered = message.frame_request.run_count > 0;
  client->plan.model.servers[index].chunk_rows = ordered ? kChunkRowsMin : kChunkRowsEven;
  const std::uint32_t chunk_rows = ordered ? kChunkRowsMax : kChunkRowsEven;
  message.frame_request.chunk_rows = static_cast<std::uint16_t>(std::min(chunk_rows, client->settings.height));
  message.frame_request.coding =
      row_coding(server->link.ns_per_byte, code_threshold(*client, *server), client->options.near_lossless);
  forget_light_of(client, index);
  want_light_with(client, server, &message.frame_request);
  if (message.frame_request.coarse_first) ++server->rows.coarse_due, client->coarse.asked = true;
  client->frame.request.coarse_first = false;
  std::uint64_t bytes = server->rows.frame.bytes, row_bytes = server->rows.frame.row_bytes;
  server->rows.frame = ServerFrame();
  server->rows.frame.row_begin = row_begin, server->rows.frame.row_end = row_end;
  server->rows.frame.asked_ns = client_now_ns(*client), server->rows.frame.bytes = bytes,
  server->rows.frame.row_bytes = row_bytes;
  server->rows.frame.open = true;
  send_request(client, server, &message);
}

void send_request(Client* client, RemoteServer* server, Message* message) {
  const bool like_the_last = server->rows.asked.frame > 0 && is_change(message->frame_request, server->rows.asked);
  message->type = like_the_last ? MessageType::frame_change : MessageType::frame_request;
  const FrameRequest& q = server->rows.asked = message->frame_request;
  server->rows.late_rows += server->rows.due_rows;
  server->rows.due = first_rows(q), server->rows.due_rows = q.row_end - q.row_begin;
  server->light.asked_ns = q.light_pitch > 0 ? client_now_ns(*client) : 0;
  if (!send_message(&server->messages, *message)) return lose_server(client, server, "it stopped reading");
  if (!server->rows.unanswered)
    server->overture.timer = platform::link_timer(client_now_ns(*client), silence_limit_ns(*client, *server));
  server->rows.unanswered = true;
  flush_server(client, server);
}

double device_pixel_ns(const Client& client) {
  double width = client.settings.width;
  if (client.frame.device_pixels > 0) return client.frame.device_ns / static_cast<double>(client.frame.device_pixels);
  double sum = 0;
  std::uint32_t count = 0;
  for (const RowModel& row : client.plan.model.rows)
    if (is_known(row.device_ns)) sum += static_cast<double>(row.device_ns.value), ++count;
  return count ? sum / (width * count) : 0;
}

void share_rows(Client* client) {
  CHECK(client->options.has_scene && !client->frame.complete);
  const bool by_effect = client->light.by_effect;
  RowsOfDevice own;
  if (by_effect) own = {own_light_part(*client), mapper_of_frame(client)};
  SplitProblem problem = make_problem(&client->plan.model, client->options.wish, own);
  // Times count from the start of the frame: the device can render once it is prepared, servers start when asked.
  const std::uint64_t elapsed_ns = client_elapsed_ns(*client);
  auto from_now = [&](std::uint64_t* start_ns) { *start_ns = std::min(kRowTableMax, *start_ns + elapsed_ns); };
  if (client->frame.prepared)
    problem.device_start_ns = std::min(kRowTableMax, client->frame.prepare_ns);
  else
    from_now(&problem.device_start_ns);
  from_now(&problem.link_start_ns);
  for (std::uint32_t i = 0; i < client->server_count; ++i) from_now(&problem.servers[i].start_ns);
  if (client->options.device_share >= 0)
    client->plan.split = split_by_share(*client, problem);
  else
    client->plan.split = client->frame.device_pixels > 0
                             ? find_split(problem, &client->plan.workspace)
                             : next_split(problem, client->plan.split, &client->plan.workspace);
  client->share.predicted_ns = static_cast<double>(client->plan.split.time_ns);
  const std::uint64_t link_ns = problem.link_ns[problem.row_count] - problem.link_ns[client->plan.split.boundary[0]];
  client->plan.link_trial.limited =
      link_ns > 0 && static_cast<double>(problem.link_start_ns + link_ns) >= kLinkLimited * client->share.predicted_ns;
  Split alone;
  alone.server_count = client->server_count;
  for (std::uint32_t& boundary : alone.boundary) boundary = problem.row_count;
  predict_split(problem, &alone);
  client->frame.alone_ns = client->share.local_ns = static_cast<double>(alone.time_ns);
  // Reports the device's time for all of the light.
  if (by_effect)
    client->share.local_ns += static_cast<double>(problem.device_ns[problem.row_count]) * (1 / own.part - 1);
  auto rows_of = [&](std::uint32_t i) { return client->plan.split.boundary[i + 1] - client->plan.split.boundary[i]; };
  std::uint32_t largest = 0;
  for (std::uint32_t i = 1; i < client->server_count; ++i)
    if (rows_of(i) > rows_of(largest)) largest = i;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (server->overture.phase != ServerPhase::ready) continue;  // for others, the overture's figure stands
    server->link.ns_per_byte = static_cast<double>(client->plan.model.servers[i].ns_per_byte.value);
    if (i == largest) want_coarse(client, client->share.predicted_ns);
    ask_for_rows(client, server, client->plan.split.boundary[i], client->plan.split.boundary[i + 1], &problem);
    client->frame.request.coarse_first = false;
  }
  client->frame.joined = true;
  if (by_effect) ask_for_light(client);
}

void let_join(Client* client) {
  if (!client->options.has_scene) return ask_idle_servers(client);
  if (client->frame.complete || client->frame.unchanged) return;
  if (!divides_rows(*client)) return ask_for_light(client);
  const bool by_effect = client->light.by_effect;
  bool any = false;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    if (!by_effect && client->servers[i].overture.phase == ServerPhase::probing)
      finish_probe(client, &client->servers[i]);
    any = any || client->servers[i].overture.phase == ServerPhase::ready;
  }
  if (!by_effect) probe_servers(client);
  if (client->frame.joined || !any) return;
  if (client->frame.held ? wants_quiet(*client)
                         : !is_settled(*client) && client->picture.merge.next_row < client->settings.height / 4)
    return;
  share_rows(client);
}

namespace {

// A link is at least as fast as its bytes came: corrects estimates below that.
void measure_own_links(Client* client) {
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    const ServerFrame& f = client->servers[i].rows.frame;
    double ns = static_cast<double>(f.heard_ns - f.first_ns), bytes = static_cast<double>(f.bytes_behind);
    if (bytes == 0 || ns < kGapsMin * static_cast<double>(client->frame.arrivals.gap_ns_max)) continue;
    if (ns < bytes * static_cast<double>(client->plan.model.servers[i].ns_per_byte.value))
      observe_transfer(&client->plan.model, i, bytes, ns);
  }
}

// All of a server's rows came since they were requested, however rarely the
// device polled, so its link is at least that fast. Its actual speed must be
// measured.
void bound_own_links(Client* client) {
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    Smoothed* ns_per_byte = &client->plan.model.servers[i].ns_per_byte;
    double ns = static_cast<double>(server->rows.frame.heard_ns - server->rows.frame.asked_ns);
    double bytes = static_cast<double>(server->rows.frame.bytes_behind);
    bool disproved = kDisproved * ns < bytes * static_cast<double>(ns_per_byte->value);
    if (server->overture.phase != ServerPhase::ready || bytes == 0 || !disproved) continue;
    *ns_per_byte = Smoothed();
    smooth(ns_per_byte, ns / bytes);
    observe_own_link(&client->plan.model, ns / bytes);
    server->link.scaled = kUnsound;
  }
}

// Times of a frame's rows on a link that all servers share.
struct LinkUse {
  std::uint32_t server_count = 0;     // that sent rows
  double sent_ns = 0, chunks_ns = 0;  // to send their rows, and a chunk of each
  double render_ns = 0;               // longest time to trace a server's rows
};

double chunk_part(const ServerModel& model, const ServerFrame& f) {
  CHECK_GT(f.rows_come, 0u);
  return std::min(1.0, static_cast<double>(model.chunk_rows) / f.rows_come);
}

double shared_link_ns(const Client& client, const ServerFrame& f) {
  return static_cast<double>(f.bytes) * static_cast<double>(client.plan.model.link_ns_per_byte.value);
}

LinkUse link_use(const Client& client) {
  LinkUse use;
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const ServerFrame& f = client.servers[i].rows.frame;
    if (f.rows_come == 0) continue;
    const double sent_ns = shared_link_ns(client, f);
    ++use.server_count;
    use.sent_ns += sent_ns, use.chunks_ns += sent_ns * chunk_part(client.plan.model.servers[i], f);
    use.render_ns = std::max(use.render_ns, f.render_ns);
  }
  return use;
}

// A server's start, preparation of the frame included, is the time of its rows beyond their work and bytes. If others
// share the link, they may have waited for it, so this bounds the start from above. A round trip and the preparation
// stated by the server bound it from below; so do its rows, if the link keeps up, since its last chunk then waits for
// at most one chunk of each other server.
void measure_starts(Client* client) {
  const LinkUse use = link_use(*client);
  const bool keeps_up = is_known(client->plan.model.link_ns_per_byte) && use.sent_ns < kLightLink * use.render_ns;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    const ServerFrame& f = client->servers[i].rows.frame;
    const ServerModel& model = client->plan.model.servers[i];
    if (client->servers[i].overture.phase != ServerPhase::ready || f.open || f.rows_come < f.row_end - f.row_begin)
      continue;
    if (f.rows_come == 0 || !is_known(model.start_ns)) continue;
    const double transfer = static_cast<double>(f.bytes) * static_cast<double>(model.ns_per_byte.value);
    const double part = chunk_part(model, f);
    const double work = std::max(f.render_ns, transfer) + part * std::min(f.render_ns, transfer);
    const double latest = std::max(0.0, static_cast<double>(f.heard_ns - f.asked_ns) - work);
    const double seen = latest - static_cast<double>(f.unseen_ns), known = static_cast<double>(model.start_ns.value);
    if (known > latest) observe_start(&client->plan.model, i, latest);
    if (use.server_count == 1) {
      if (known < seen) observe_start(&client->plan.model, i, seen);
      continue;
    }
    const double prepared = f.prepare_ns > 0 ? client->servers[i].link.round_trip_ns + f.prepare_ns : 0;
    const double waited = use.chunks_ns - part * shared_link_ns(*client, f);
    const double earliest = std::max(std::min(latest, prepared), keeps_up ? seen - waited : 0);
    if (known < earliest) observe_start(&client->plan.model, i, known + kRaise * (earliest - known));
  }
}

// Bytes per nanosecond that a server produces after its first chunk. Arrivals count from that chunk, whose rows may be
// far cheaper than the rest.
double rate_of(const ServerFrame& f) {
  if (f.render_behind_ns > 0) return static_cast<double>(f.bytes_behind) / f.render_behind_ns;
  return f.render_ns > 0 ? static_cast<double>(f.bytes) / f.render_ns : 0;
}

}  // namespace

void measure_link(Client* client) {
  measure_starts(client);
  bound_own_links(client);
  const Arrivals& a = client->frame.arrivals;
  double ns = static_cast<double>(a.last_ns - a.first_ns), bytes = static_cast<double>(a.bytes);
  if (bytes == 0 || ns < kGapsMin * static_cast<double>(a.gap_ns_max)) return;
  measure_own_links(client);
  double rate = 0;     // bytes per nanosecond from all servers
  double longest = 0;  // longest time of a server to trace its rows and then send them
  std::uint32_t count = 0, last = 0;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    const ServerFrame& f = client->servers[i].rows.frame;
    if (f.rows_come == 0 || client->servers[i].overture.phase != ServerPhase::ready) continue;
    rate += rate_of(f);
    const double sent_ns =
        static_cast<double>(f.bytes) * static_cast<double>(client->plan.model.servers[i].ns_per_byte.value);
    longest = std::max(longest, f.render_ns + sent_ns);
    ++count, last = i;
  }
  Smoothed* link = &client->plan.model.link_ns_per_byte;
  double before = is_known(*link) ? static_cast<double>(link->value) : 0;
  bool link_bound = rate > 0 && ns / bytes * rate > kLinkBound, better = ns / bytes < before;
  // Servers start and end at different times, which stretches the time between their first and last rows.
  if (count > 1 && ns < kLinkBound * longest) link_bound = false;
  if (count == 0 || !(link_bound || better)) return;
  smooth(link, ns / bytes);
  if (count == 1 && link_bound) observe_transfer(&client->plan.model, last, bytes, ns);
  if (!(before > 0)) return;
  // Each link is measured separately once its figure has become doubtful.
  double factor = static_cast<double>(link->value) / before;
  if (count == 1) {
    if (link_bound) client->servers[last].link.scaled *= factor;
    return;
  }
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    scale(&client->plan.model.servers[i].ns_per_byte, factor);
    client->servers[i].link.scaled *= factor;
  }
}

void try_link(Client* client) {
  LinkTrial* trial = &client->plan.link_trial;
  Smoothed* link = &client->plan.model.link_ns_per_byte;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < client->server_count; ++i) count += client->servers[i].rows.frame.rows_come > 0;
  if (!trial->limited || count < 2 || !is_known(*link)) return;
  const float before = trial->before;
  trial->before = 0;
  if (client->share.measured_ns > kLinkKept * client->share.predicted_ns) {
    if (before == 0) return;
    scale(link, static_cast<double>(before / link->value));
    trial->rests_until = client->plan.frames_with_servers + trial->rest;
    trial->rest = std::min(2 * trial->rest, kLinkRestMax);
  } else if (client->plan.frames_with_servers >= trial->rests_until) {
    if (before > 0) trial->rest = 1;
    trial->before = link->value;
    scale(link, kLinkFaster);
  }
}

}  // namespace pocketray
