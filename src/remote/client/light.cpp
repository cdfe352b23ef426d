#include "remote/client/light.h"

#include <algorithm>

#include "base/check.h"
#include "indirect/ambient.h"
#include "indirect/environment.h"
#include "remote/client/parts.h"
#include "wire/light_coder.h"

namespace pocketray {
namespace {

bool same_view(const FrameRequest& a, const FrameRequest& b) {
  const Camera &p = a.camera, &q = b.camera;
  return a.seconds == b.seconds && p.eye == q.eye && p.target == q.target && p.up == q.up &&
         p.vertical_fov == q.vertical_fov && p.vertical_extent == q.vertical_extent && p.projection == q.projection &&
         same_quality(a.settings, b.settings);
}

// A server that can render the light, and would take least; null: none. One that has passed its overture as far as the
// measurement of its link needs no rows for that.
RemoteServer* best_server(Client* client) {
  RemoteServer* best = nullptr;
  for (std::uint32_t i = 0; i < client->server_count; ++i) {
    RemoteServer* server = &client->servers[i];
    if (server->lied || server->phase < ServerPhase::probing) continue;
    if (!best || server->price < best->price) best = server;
  }
  return best;
}

// Whether a server may soon be able to, before the first map.
bool is_one_joining(const Client& client) {
  if (client.light.map_request.frame > 0 || client.request.frame > 1) return false;
  return std::any_of(client.servers, client.servers + client.server_count, [](const RemoteServer& server) {
    const bool waits = server.phase == ServerPhase::waiting;
    return !server.lied && server.phase < ServerPhase::probing && !(waits && server.told);
  });
}

void request_light(Client* client, RemoteServer* server) {
  ClientLight* l = &client->light;
  Message message;
  message.frame_request = client->request;
  FrameRequest* q = &message.frame_request;
  q->light_pitch = static_cast<std::uint8_t>(l->grid.pitch);
  q->row_begin = 0, q->row_end = static_cast<std::uint16_t>(client->settings.height);
  q->run_count = 0, q->coarse_first = false;
  const bool like_the_last = server->asked.frame > 0 && is_change(*q, server->asked);
  message.type = like_the_last ? MessageType::frame_change : MessageType::frame_request;
  server->late_rows += server->due_rows;
  server->due_rows = 0;
  ++server->light_due;
  server->asked = l->asked = *q;
  l->asked_server = index_of(*client, server), l->last_asked = q->frame;
  l->asked_ns = client_now_ns(*client);
  l->has_surfaces = l->has_come = false;
  if (!send_message(&server->messages, message)) return lose_server(client, server, "it stopped reading");
  if (!server->unanswered) server->timer = platform::link_timer(l->asked_ns, silence_limit_ns(*client, *server));
  server->unanswered = true;
  flush_server(client, server);
}

// Takes the surfaces that the map of this frame shows, once the frame is traced, and the map, once it has come.
void take_map(Renderer* renderer, Client* client) {
  ClientLight* l = &client->light;
  const std::uint32_t next = 1 - l->newest;
  if (l->asked.frame > 0 && l->asked.frame == client->request.frame && !l->has_surfaces) {
    take_mapped_surfaces(renderer, l->first_hits.data, l->grid, l->surfaces[next].data);
    l->asked_camera = renderer->frame.camera;
    l->has_surfaces = true;
  }
  if (l->asked.frame == 0 || !l->has_surfaces || !l->has_come) return;
  l->newest = next;
  l->map = {l->grid, l->asked_camera, l->asked.seconds, l->surfaces[next].data, l->light[next].data};
  l->map_request = l->asked;
  l->asked.frame = 0;
}

// The device's own: ambient light, or what the scene has besides stored radiosity, which is among what servers render.
IndirectChoice own_indirect(const Scene& scene) {
  const bool has_ambient = AmbientIndirect::use(scene) != IndirectUse::nothing;
  return has_ambient || scene.radiosity_values.empty() ? indirect_choice(Effect::ambient) : IndirectChoice::none;
}

const char* unfit_because(const Renderer& renderer) {
  const EffectMask mask = renderer.effects.mask;
  if (!has(mask, Effect::radiosity) && !has(mask, Effect::instant_radiosity))
    return "the scene has no indirect light but ambient light: give --indirect instant-radiosity, or bake --radiosity";
  const bool mixes = has(mask, Effect::radiosity) || own_indirect(renderer.scene) == IndirectChoice::none;
  if (mixes && environment_of(renderer.scene)) return "radiosity stores the environment's light, too";
  return nullptr;
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

}  // namespace

std::size_t light_need(const Settings& settings, const LightOptions& o) {
  if (o.split == SplitKind::rows) return 0;
  const std::size_t lights = light_count(light_grid(settings, o.pitch));
  return arena_need<Hit>(first_hit_count(settings)) +
         2 * (arena_need<MappedSurface>(lights) + arena_need<Vec3>(lights));
}

std::size_t light_message_bytes_max(const Settings& settings, const LightOptions& o) {
  if (o.split == SplitKind::rows) return 0;
  return light_map_prefix_bytes() + light_bytes_max(light_count(light_grid(settings, o.pitch)));
}

void make_light(const LightOptions& o, const Settings& settings, Arena* arena, ClientLight* light) {
  *light = ClientLight();
  if (o.split == SplitKind::rows) return;
  CHECK(o.pitch >= kLightPitchMin && o.pitch <= kLightPitchMax);
  CHECK_GE(o.every, 1u);
  light->grid = light_grid(settings, o.pitch);
  light->first_hits = arena_array<Hit>(arena, static_cast<std::uint32_t>(first_hit_count(settings)));
  for (int i = 0; i < 2; ++i) {
    light->surfaces[i] = arena_array<MappedSurface>(arena, light_count(light->grid));
    light->light[i] = arena_array<Vec3>(arena, light_count(light->grid));
  }
}

Status choose_split(Renderer* renderer, Client* client) {
  ClientLight* l = &client->light;
  const LightOptions& o = client->options.light;
  l->by_effect = false;
  if (o.split == SplitKind::rows || !client->options.has_scene) return success();
  const bool any = best_server(client) != nullptr;
  bool wanted = o.split == SplitKind::effect || (any && choose_by_effect(&l->choice));
  if (wanted) {
    RETURN_IF_ERROR(set_indirect(renderer, o.indirect));
    const char* reason = unfit_because(*renderer);
    if (!reason) {
      RETURN_IF_ERROR(set_indirect(renderer, own_indirect(renderer->scene)));
      reason = light_map_unfit(*renderer);
    }
    if (reason) log_unfit(client, reason);
    wanted = reason == nullptr;
  }
  if (!wanted) RETURN_IF_ERROR(set_indirect(renderer, o.indirect));
  l->by_effect = wanted;
  return success();
}

void begin_light_frame(Client* client) {
  ClientLight* l = &client->light;
  if (l->grid.pitch == 0) return;
  // Without the frame's first hits, nobody knows what the map shows.
  if (l->asked.frame > 0 && !l->has_surfaces) l->asked.frame = 0;
  l->rests = l->last.frame > 0 && same_view(l->last, client->request);
  l->last = client->request;
  l->traced_ns = 0, l->rows_lit = 0, l->is_done = false;
  l->times = EffectTimes();
  client->share.by_effect = l->by_effect;
  ask_for_light(client);
}

void ask_for_light(Client* client) {
  ClientLight* l = &client->light;
  if (!l->by_effect || client->complete || l->rows_lit > 0 || l->is_done || l->asked.frame > 0) return;
  const std::uint32_t frame = client->request.frame;
  if (l->last_asked == frame) return;  // its server was lost
  const bool has_map = l->map_request.frame > 0;
  if (has_map && same_view(l->map_request, client->request)) return;
  if (has_map && !l->rests && frame - l->last_asked < client->options.light.every) return;
  if (RemoteServer* server = best_server(client)) request_light(client, server);
}

void take_light(Client* client, RemoteServer* server, LightMapMessage message) {
  ClientLight* l = &client->light;
  if (server->light_due == 0) return lose_server(client, server, kUnasked);
  message.frame = frame_of(message.frame, server->asked.frame);
  server->light_due = message.frame == server->asked.frame ? 0 : server->light_due - 1;
  server->price = message.price;
  if (server->light_due == 0) server->late_rows = server->late_at_ping = 0;
  const std::uint32_t index = index_of(*client, server), bytes = light_map_prefix_bytes() + message.bytes.count;
  observe_price(&client->model, index, price_ratio(message.price));
  server->frame.bytes += bytes;
  client->share.light_bytes += bytes;
  if (message.frame != l->asked.frame || index != l->asked_server || l->has_come) return;
  if (!decode_light(message.bytes.data, message.bytes.count, l->grid.columns, l->grid.rows,
                    l->light[1 - l->newest].data))
    return lose_server(client, server, "it sent light that cannot be decoded");
  l->has_come = true;
  const double took_ns = static_cast<double>(client_now_ns(*client) - l->asked_ns);
  l->times.server_ns = 1e-3 * message.light_ps * light_count(l->grid) * price_ratio(message.price);
  l->times.transfer_ns = std::max(0.0, took_ns - l->times.server_ns);
  if (server->phase == ServerPhase::probing && client->options.light.split == SplitKind::effect)
    server_is_ready(client, server);
  if (server->useful_ns == 0 || server->told) server_is_useful(client, server);
}

void forget_light_of(Client* client, std::uint32_t server) {
  ClientLight* l = &client->light;
  if (l->asked_server == server) l->asked.frame = 0;  // its map, if it still comes, is of no use
}

bool is_lit(Renderer* renderer, Client* client) {
  constexpr std::uint32_t kRowsAtOnce = 16;  // chosen: a fifteenth of a handheld's screen between two looks
  ClientLight* l = &client->light;
  if (!l->by_effect || l->is_done) return true;
  const std::uint64_t now = client_now_ns(*client);
  if (l->traced_ns == 0) ask_for_light(client), l->traced_ns = now;
  take_map(renderer, client);
  const LightOptions& o = client->options.light;
  const bool is_due = l->rows_lit == 0 && (l->asked.frame == client->request.frame || is_one_joining(*client));
  const std::uint64_t wait_ns = o.wait_ns > 0 ? o.wait_ns : static_cast<std::uint64_t>(client->device_ns);
  if (is_due && now - l->traced_ns < wait_ns) return false;
  const std::uint32_t height = client->settings.height;
  if (l->map_request.frame > 0) {
    const std::uint32_t end = std::min(height, l->rows_lit + kRowsAtOnce);
    add_mapped_light(renderer, l->first_hits.data, l->map, l->rows_lit, end);
    pack_device_rows(*renderer, client, l->rows_lit, end);
    mark_dirty(client, l->rows_lit, end);
    l->times.add_ns += static_cast<double>(take_time(client, 0, now));
    l->rows_lit = end;
    client->share.has_light = true;
    client->share.light_age = client->request.frame - l->map_request.frame;
  }
  return l->is_done = l->map_request.frame == 0 || l->rows_lit == height;
}

void end_light_frame(Client* client) {
  ClientLight* l = &client->light;
  if (l->grid.pitch == 0) return;
  if (!l->by_effect) {
    if (client->joined) observe_rows_frame(&l->choice, client->share.measured_ns);
    return;
  }
  l->times.prepare_ns = static_cast<double>(client->prepare_ns);
  l->times.device_ns = client->device_ns;
  observe_effect_frame(&l->choice, l->times);
  client->share.predicted_ns = predict_effect_ns(l->choice);
}

}  // namespace pocketray
