#include "remote/client/light.h"

#include <algorithm>

#include "base/check.h"
#include "plan/resolve.h"
#include "remote/client/parts.h"
#include "wire/light_coder.h"

namespace pocketray {
namespace {

// Chosen: as long as a server may take for any other answer (ClientOptions::silence_timeout_ns).
constexpr std::uint64_t kUnlitNs = 3'000'000'000;

bool same_view(const FrameRequest& a, const FrameRequest& b) {
  const Camera &p = a.camera, &q = b.camera;
  return a.seconds == b.seconds && p.eye == q.eye && p.target == q.target && p.up == q.up &&
         p.vertical_fov == q.vertical_fov && p.vertical_extent == q.vertical_extent && p.projection == q.projection &&
         same_quality(a.settings, b.settings);
}

// Returns the fastest server among those that can render the light and have failed to deliver it least often; null:
// none. A server past the measurement of its link qualifies without having sent rows.
RemoteServer* best_server(Client* client) {
  RemoteServer* best = nullptr;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (server->overture.lied || server->overture.phase < ServerPhase::probing) continue;
    const bool is_better =
        best && (server->light.missed != best->light.missed ? server->light.missed < best->light.missed
                                                            : server->rows.price < best->rows.price);
    if (!best || is_better) best = server;
  }
  return best;
}

// True if a server may soon qualify, before the first map.
bool is_one_joining(const Client& client) {
  if (client.light.map_request.frame > 0 || client.frame.request.frame > 1) return false;
  return std::any_of(client.servers, client.servers + client.server_count, [](const RemoteServer& server) {
    const bool waits = server.overture.phase == ServerPhase::waiting;
    return !server.overture.lied && server.light.missed == 0 && server.overture.phase < ServerPhase::probing &&
           !(waits && server.overture.told);
  });
}

// Requests only the light.
void request_light(Client* client, RemoteServer* server) {
  Message message;
  message.frame_request = client->frame.request;
  FrameRequest* q = &message.frame_request;
  q->row_begin = q->row_end = 0;
  q->run_count = 0, q->coarse_first = false;
  want_light_with(client, server, q);
  send_request(client, server, &message);
}

bool is_own(const Client& client, std::uint32_t row) {
  return client.picture.merge.rows[row].state == RowState::device;
}

// Returns the device's next rows from `begin` on that still lack light, at most `count_max`, skipping servers' rows.
// While the device may still take rows, stops at the first that it may take.
RowRange own_rows(const Client& client, std::uint32_t begin, std::uint32_t count_max) {
  const std::uint32_t limit = has_all_rows(client) ? client.settings.height : client.picture.merge.next_row;
  while (begin < limit && !is_own(client, begin)) ++begin;
  std::uint32_t end = begin;
  while (end < limit && end - begin < count_max && is_own(client, end)) ++end;
  return {begin, end};
}

double mean_device_part(const Client& client) {
  double sum = 0;
  for (const RowModel& row : client.plan.model.rows) sum += static_cast<double>(row.device_part);
  return sum / client.settings.height;
}

// Records the time of adding light to rows that the device has rendered.
void observe_light_added(Client* client, std::uint32_t row_begin, std::uint32_t row_end, double ns) {
  if (!client->light.shares_rows) return;
  const auto each_ns = static_cast<float>(ns / (row_end - row_begin));
  for (std::uint32_t row = row_begin; row < row_end; ++row)
    if (client->plan.model.rows[row].device_ns_seen > 0) client->plan.model.rows[row].device_ns_seen += each_ns;
}

// Takes the surfaces that this frame's map shows once the device's rows are traced, and the map once it has
// come.
void take_map(Renderer* renderer, Client* client) {
  ClientLight* l = &client->light;
  const std::uint32_t next = 1 - l->newest;
  if (l->asked.frame > 0 && l->asked.frame == client->frame.request.frame && !l->has_surfaces) {
    std::uint32_t row_end = 0;
    while (row_end < client->settings.height && is_own(*client, row_end)) ++row_end;
    take_mapped_surfaces(renderer, l->first_hits.data, row_end, l->grid, l->surfaces[next].data);
    l->asked_camera = renderer->frame.view.camera;
    l->has_surfaces = true;
  }
  if (l->asked.frame == 0 || !l->has_surfaces || !l->has_come) return;
  l->newest = next;
  l->map = {l->grid, l->asked_camera, l->asked.seconds, l->surfaces[next].data, l->light[next].data};
  l->map_request = l->asked;
  l->asked.frame = 0;
}

// Sets the indirect light of the device's frames.
Status set_indirect(Renderer* renderer, IndirectChoice choice) {
  if (renderer->settings.indirect == choice) return success();
  Settings settings = renderer->settings;
  settings.indirect = choice;
  return change_settings(renderer, settings);
}

void log_unfit(Client* client, const char* reason) {
  if (client->light.unfit || !client->options.log) return;
  client->light.unfit = reason;
  char line[200];
  std::snprintf(line, sizeof line, "frames are shared by rows, not by effect: %s", reason);
  client->options.log(client->options.log_context, line);
}

// Logs once that a frame lacks the light asked for: at once if the frame waits for it, otherwise after a while, since
// the first map comes after the first frames.
void tell_unlit(Client* client) {
  ClientLight* l = &client->light;
  const FrameShare& share = client->share;
  const std::uint64_t now = client_now_ns(*client);
  if (share.has_light || share.device_rows == 0) {
    l->unlit_ns = 0;
    return;
  }
  if (l->unlit_ns == 0) l->unlit_ns = now;
  const bool is_told = client->options.light.wait_ns > 0 || now - l->unlit_ns >= kUnlitNs;
  if (l->told_unlit || !is_told || !client->options.log) return;
  l->told_unlit = true;
  char line[200];
  std::snprintf(
      line, sizeof line,
      "frame %u has the device's own indirect light instead of that of --indirect %s: no server sent it in time",
      share.frame, kIndirectNames.names[static_cast<int>(client->options.light.indirect)]);
  client->options.log(client->options.log_context, line);
}

// Returns whether the current frame is to have its own map.
bool wants_map(const Client& client) {
  const ClientLight& l = client.light;
  if (!l.by_effect || l.asked.frame > 0) return false;
  const std::uint32_t frame = client.frame.request.frame;
  const bool has_map = l.map_request.frame > 0;
  if (has_map && same_view(l.map_request, client.frame.request)) return false;
  // A map requested in this frame may have been lost with its server.
  return !has_map || l.rests || frame == l.last_asked || frame - l.last_asked >= client.options.light.every;
}

// Includes the value of its cost, if the user weighs cost.
double predict_ns(Client* client, const RowsOfDevice& rows, const Smoothed& error) {
  const SplitProblem problem = make_problem(&client->plan.model, client->options.wish, rows);
  const Split split = find_split(problem, &client->plan.workspace);
  return static_cast<double>(split.time_ns) * value_or(error, 1) +
         (problem.weigh_cost ? static_cast<double>(split.cost) : 0);
}

// Predicts the time of frames shared by rows and by effect, by the cost model.
void predict_ways(Client* client) {
  ClientLight* l = &client->light;
  // Frames by effect are traced whole; the next frame by rows traces what the last of them did.
  RowsOfDevice rows;
  if (l->choice.by_effect) rows.part = l->rows_part;
  l->rows_ns = predict_ns(client, rows, l->choice.rows_error);
  l->effect_ns = 0;
  const RemoteServer* mapper = best_server(client);
  if (!mapper || !is_known(client->plan.model.light.own_part) || !is_known(client->plan.model.light.arrival_ns)) return;
  l->effect_ns = predict_ns(client, {own_light_part(*client), index_of(*client, mapper)}, l->choice.effect_error);
}

// Alternates between both ways, or chooses the one predicted to be faster.
bool is_effect_wanted(Client* client) {
  ClientLight* l = &client->light;
  // Servers come into use by rows; one whose rows never come in time does not keep the others from sending light.
  const std::uint64_t now = client_now_ns(*client), limit = client->options.silence_timeout_ns;
  const bool probes = std::any_of(client->servers, client->servers + client->server_count, [&](const RemoteServer& s) {
    return s.overture.phase == ServerPhase::measuring ||
           (s.overture.phase == ServerPhase::probing && now - s.overture.phase_ns < limit);
  });
  if (probes || !best_server(client)) return false;
  predict_ways(client);
  return choose_by_effect(&l->choice, l->rows_ns, l->effect_ns);
}

}  // namespace

std::size_t light_need(const Settings& settings, const LightOptions& o) {
  if (o.split == SplitKind::rows) return 0;
  const std::size_t lights = light_count(light_grid(settings, kLightPitch));
  return arena_need<Hit>(first_hit_count(settings)) +
         2 * (arena_need<MappedSurface>(lights) + arena_need<Vec3>(lights));
}

std::size_t light_message_bytes_max(const Settings& settings, const LightOptions& o) {
  if (o.split == SplitKind::rows) return 0;
  return light_map_prefix_bytes() + light_bytes_max(light_count(light_grid(settings, kLightPitch)));
}

void make_light(const LightOptions& o, const Settings& settings, Arena* arena, ClientLight* light) {
  *light = ClientLight();
  if (o.split == SplitKind::rows) return;
  CHECK_GE(o.every, 1u);
  light->grid = light_grid(settings, kLightPitch);
  light->first_hits = arena_array<Hit>(arena, static_cast<std::uint32_t>(first_hit_count(settings)));
  for (int i = 0; i < 2; ++i) {
    light->surfaces[i] = arena_array<MappedSurface>(arena, light_count(light->grid));
    light->light[i] = arena_array<Vec3>(arena, light_count(light->grid));
  }
}

Status choose_split(Renderer* renderer, Client* client) {
  ClientLight* l = &client->light;
  const LightOptions& o = client->options.light;
  l->by_effect = l->shares_rows = false;
  if (o.split == SplitKind::rows || !client->options.has_scene) return success();
  bool wanted = o.split == SplitKind::effect || is_effect_wanted(client);
  if (wanted) {
    RETURN_IF_ERROR(set_indirect(renderer, o.indirect));
    const char* reason = mapped_light_unfit(*renderer);
    if (!reason) {
      RETURN_IF_ERROR(set_indirect(renderer, own_indirect(renderer->scene)));
      reason = unshared_because(renderer->effects.mask);
    }
    if (reason) log_unfit(client, reason);
    wanted = reason == nullptr;
  }
  if (!wanted) RETURN_IF_ERROR(set_indirect(renderer, o.indirect));
  l->by_effect = wanted;
  l->shares_rows = wanted && o.split == SplitKind::automatic;
  return success();
}

void begin_light_frame(Client* client) {
  ClientLight* l = &client->light;
  if (l->grid.pitch == 0) return;
  // Without the frame's first hits, the map's surfaces are unknown.
  if (l->asked.frame > 0 && !l->has_surfaces) l->asked.frame = 0;
  l->rests = l->last.frame > 0 && same_view(l->last, client->frame.request);
  l->last = client->frame.request;
  l->traced_ns = 0, l->rows_lit = 0, l->is_done = false;
  l->times = EffectTimes();
  client->share.by_effect = l->by_effect;
  if (!l->shares_rows) ask_for_light(client);
}

bool want_light_with(Client* client, RemoteServer* server, FrameRequest* q) {
  ClientLight* l = &client->light;
  if (!wants_map(*client) || server != best_server(client)) return false;
  q->light_pitch = static_cast<std::uint8_t>(l->grid.pitch);
  ++server->light.due;
  l->asked = *q;
  l->asked_server = index_of(*client, server), l->last_asked = q->frame;
  l->asked_ns = client_now_ns(*client);
  l->has_surfaces = l->has_come = false;
  return true;
}

double own_light_part(const Client& client) { return value_or(client.plan.model.light.own_part, 1); }

std::uint32_t mapper_of_frame(Client* client) {
  const RemoteServer* server = wants_map(*client) ? best_server(client) : nullptr;
  return server ? index_of(*client, server) : kNone;
}

void ask_for_light(Client* client) {
  const ClientLight& l = client->light;
  if (client->frame.complete || l.rows_lit > 0 || l.is_done || !wants_map(*client)) return;
  RemoteServer* server = best_server(client);
  if (server && !server->rows.frame.open) request_light(client, server);
}

void take_light(Client* client, RemoteServer* server, LightMapMessage message) {
  ClientLight* l = &client->light;
  message.frame = frame_of(message.frame, server->rows.asked.frame);
  const bool is_last = message.frame == server->rows.asked.frame;
  if (server->light.due <= (is_last ? 0u : awaits_light(*server))) return lose_server(client, server, kUnasked);
  server->light.due = is_last ? 0 : server->light.due - 1;
  if (is_last) server->light.asked_ns = 0;
  server->rows.price = message.price;
  if (server->light.due == 0) server->rows.late_rows = server->link.late_at_ping = 0;
  const std::uint32_t index = index_of(*client, server), bytes = light_map_prefix_bytes() + message.bytes.count;
  observe_price(&client->plan.model, index, price_ratio(message.price));
  server->rows.frame.bytes += bytes;
  client->share.light_bytes += bytes;
  if (message.frame != l->asked.frame || index != l->asked_server || l->has_come) return;
  if (!decode_light(message.bytes.data, message.bytes.count, l->grid.columns, l->grid.rows,
                    l->light[1 - l->newest].data))
    return lose_server(client, server, "it sent light that cannot be decoded");
  l->has_come = true;
  server->light.missed = 0;
  const double took_ns = static_cast<double>(client_now_ns(*client) - l->asked_ns);
  l->times.server_ns = 1e-3 * message.light_ps * light_count(l->grid) * price_ratio(message.price);
  l->times.transfer_ns = std::max(0.0, took_ns - l->times.server_ns);
  observe_map(&client->plan.model, l->times.server_ns, bytes, took_ns);
  if (server->overture.phase == ServerPhase::probing && !l->shares_rows) server_is_ready(client, server);
  if (server->overture.useful_ns == 0 || server->overture.told) server_is_useful(client, server);
}

void forget_light_of(Client* client, std::uint32_t server) {
  ClientLight* l = &client->light;
  if (l->asked_server == server) l->asked.frame = 0;  // its map, if it still comes, is useless
}

bool light_rows(Renderer* renderer, Client* client) {
  constexpr std::uint32_t kRowsAtOnce = 16;  // chosen: a fifteenth of a handheld's screen between two polls
  ClientLight* l = &client->light;
  if (!l->by_effect || l->is_done) return false;
  const std::uint64_t now = client_now_ns(*client);
  if (l->traced_ns == 0) ask_for_light(client), l->traced_ns = now;
  take_map(renderer, client);
  const LightOptions& o = client->options.light;
  const bool is_asked = l->asked.frame == client->frame.request.frame;
  const bool is_due = l->rows_lit == 0 && (is_asked || is_one_joining(*client));
  const bool is_patient = o.wait_ns > 0 && !(is_asked && client->servers[l->asked_server].light.missed > 0);
  const std::uint64_t since = is_patient && is_asked ? std::max(l->traced_ns, l->asked_ns) : l->traced_ns;
  const std::uint64_t wait_ns = is_patient ? o.wait_ns : static_cast<std::uint64_t>(client->frame.device_ns);
  if (is_due && now - since < wait_ns) return false;
  const bool has_all = has_all_rows(*client);
  if (l->map_request.frame == 0) {
    l->is_done = has_all;
    return false;
  }
  const RowRange rows = own_rows(*client, l->rows_lit, kRowsAtOnce);
  l->rows_lit = rows.end;
  if (rows.begin < rows.end) {
    add_mapped_light(renderer, l->first_hits.data, l->map, rows.begin, rows.end);
    pack_device_rows(*renderer, client, rows.begin, rows.end);
    mark_dirty(client, rows.begin, rows.end);
    const std::uint64_t took_ns = take_time(client, 0, now);
    observe_light_added(client, rows.begin, rows.end, static_cast<double>(took_ns));
    l->times.add_ns += static_cast<double>(took_ns);
  }
  client->share.has_light = true;
  client->share.light_age = client->frame.request.frame - l->map_request.frame;
  l->is_done = has_all && l->rows_lit == client->settings.height;
  return rows.begin < rows.end;
}

bool is_lit(const Client& client) { return !client.light.by_effect || client.light.is_done; }

void end_light_frame(Client* client) {
  ClientLight* l = &client->light;
  if (l->grid.pitch == 0) return;
  const FrameShare& share = client->share;
  if (l->by_effect) tell_unlit(client);
  const bool chooses = client->options.light.split == SplitKind::automatic;
  if (chooses && (client->frame.joined || l->by_effect) && !client->frame.unchanged)
    observe_choice(&l->choice, l->by_effect, client->plan.frames_with_servers > 1 ? share.predicted_ns : 0,
                   share.measured_ns);
  if (!l->by_effect) {
    l->rows_part = mean_device_part(*client);
    return;
  }
  l->times.prepare_ns = static_cast<double>(client->frame.prepare_ns);
  l->times.device_ns = client->frame.device_ns;
  observe_effect_times(&l->model, l->times);
  if (!l->shares_rows) client->share.predicted_ns = l->effect_ns = predict_effect_ns(l->model);
}

}  // namespace pocketray
