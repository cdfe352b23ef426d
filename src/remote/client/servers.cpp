#include "remote/client/servers.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>

#include "base/check.h"
#include "platform/entropy.h"
#include "platform/net/shaped_link.h"
#include "platform/net/tcp.h"
#include "remote/client/frame.h"
#include "remote/client/outlook.h"
#include "remote/encryption.h"

namespace pocketray {

namespace {

constexpr platform::LinkBackend const& kNet = platform::kTcpLink;
// Chosen: the longest delay after which a picture still seems to follow the buttons at once.
constexpr double kLongFrameNs = 100e6;
// Chosen: pictures in files are worth waiting for, but not for a server that never sends their light.
constexpr std::uint64_t kLightWaitNs = 60'000'000'000;

platform::LinkOptions link_options(int stream_count_max, std::size_t byte_count,
                                   std::vector<std::max_align_t>* memory) {
  memory->resize(byte_count / sizeof(std::max_align_t) + 1);
  platform::LinkOptions options;
  options.memory = memory->data();
  options.memory_bytes = memory->size() * sizeof(std::max_align_t);
  options.stream_count_max = stream_count_max;
  options.now_ns = clock_ns;
  return options;
}

Status open_link(const platform::Device* emulated, ConnectedServers* s) {
  // One more with a key: an inquiry's connection may still be closing when the client opens its own.
  const bool has_key = !s->options.key.empty();
  int streams = static_cast<int>(s->addresses.size()) + has_key;
  platform::Error error;
  CHECK_LE(s->addresses.size(), std::size_t(kServerCountMax));
  s->tcp = s->link = kNet.open(link_options(streams, kNet.need(streams), &s->tcp_memory), &error);
  if (s->tcp && emulated) {
    platform::ShapedLinkSettings radio = platform::shaped_link_settings(*emulated);
    std::size_t need = platform::shaped_link_need(streams, radio);
    s->link = platform::shaped_link_open(s->tcp, link_options(streams, need, &s->radio_memory), radio, &error);
  }
  if (s->link && has_key)
    s->inquiry_link =
        open_encrypted_link(s->link, link_options(1, encrypted_link_need(1), &s->inquiry_memory), s->key, &error);
  return s->link && (s->inquiry_link || !has_key) ? success() : failure("%s", error.text);
}

// Opens the client's link in the arena, if it is an encrypted one.
Status open_client_link(ConnectedServers* s, Arena* arena) {
  if (s->options.key.empty()) return success();
  platform::LinkOptions options;
  options.stream_count_max = static_cast<int>(s->addresses.size());
  options.memory_bytes = client_tls_need(*s);
  options.memory = arena_allocate(arena, options.memory_bytes);
  platform::Error error;
  s->client_link = open_encrypted_link(s->link, options, s->key, &error);
  return s->client_link ? success() : failure("%s", error.text);
}

void print_line(void*, const char* line) { std::fprintf(stderr, "pocketray: %s\n", line); }

WireFormat wire_format(bool small_pixels) { return small_pixels ? WireFormat::rgb565 : WireFormat::rgb888; }

Status check(const ServersOptions& o) {
  if (o.addresses.size() > kServerCountMax)
    return failure("--server is given %zu times: use at most %u servers", o.addresses.size(), kServerCountMax);
  if (o.device_share != kBestShare && !(o.device_share >= 0 && o.device_share <= 1))
    return failure("--share is %g: it must lie in 0 … 1", o.device_share);
  for (double x : {o.price, o.energy_pixel, o.energy_byte, o.cost_weight_ms, o.cost_cap})
    if (!(x >= 0 && x < 1e30)) return failure("prices, energies and their weights must not be negative");
  if (o.verify != kVerifyAuto && !(o.verify >= 0 && o.verify <= static_cast<int>(kSpotChecksMax)))
    return failure("--verify is %d: it must lie in 0 … %u", o.verify, kSpotChecksMax);
  if (o.addresses.empty() && !o.key.empty()) return failure("--key encrypts links to render servers: add --server");
  if (o.addresses.empty() && o.verify != kVerifyAuto)
    return failure("--verify checks pixels of render servers: add --server");
  if (o.addresses.empty() && o.near_lossless)
    return failure("--near-lossless applies to pixels of render servers: add --server");
  if (o.split == "rows" && o.light_every != 1) return failure("--light-every applies to --split effect and auto");
  if (o.split != "rows" && o.addresses.empty())
    return failure("--split shares frames with render servers: add --server");
  if (o.split != "rows" && o.device_share != kBestShare)
    return failure("--share and --split %s both set what the device renders: drop one of them", o.split.c_str());
  const std::pair<const char*, bool> given[] = {
      {"--share", o.device_share != kBestShare}, {"--price", o.price > 0},
      {"--energy-pixel", o.energy_pixel > 0},    {"--energy-byte", o.energy_byte > 0},
      {"--cost-weight", o.cost_weight_ms > 0},   {"--cost-cap", o.cost_cap > 0}};
  for (const auto& [option, is_given] : given)
    if (o.addresses.empty() && is_given) return failure("%s applies to render servers: add --server", option);
  if (o.cost_weight_ms > 0 && o.cost_cap > 0)
    return failure("--cost-weight and --cost-cap exclude each other: use one of them");
  return success();
}

SplitWish wish_of(const ServersOptions& o) {
  SplitWish wish;
  if (o.cost_weight_ms > 0) wish.goal = SplitGoal::time_and_cost, wish.ns_per_cost = o.cost_weight_ms * 1e6;
  if (o.cost_cap > 0) wish.goal = SplitGoal::time_under_cap, wish.cap = o.cost_cap;
  return wish;
}

LightOptions light_options(const ConnectedServers& s) {
  LightOptions light;
  const ServersOptions& o = s.options;
  if (!s.is_thin)
    light.split = o.split == "effect" ? SplitKind::effect : o.split == "auto" ? SplitKind::automatic : SplitKind::rows;
  light.every = o.light_every;
  if (!o.coarse_first) light.wait_ns = kLightWaitNs;
  return light;
}

Status open_servers(const ServersOptions& options, const platform::Device* emulated, Servers** servers) {
  *servers = nullptr;
  RETURN_IF_ERROR(check(options));
  if (options.addresses.empty()) return success();
  auto s = std::make_unique<ConnectedServers>();
  s->options = options;
  s->emulated = emulated;
  if (!options.key.empty()) RETURN_IF_ERROR(read_key(options.key, &s->key));
  for (const std::string& text : options.addresses) {
    platform::LinkAddress address;
    platform::Error error;
    if (!kNet.resolve(text.c_str(), &address, &error)) return failure("--server %s", error.text);
    s->addresses.push_back(address);
  }
  RETURN_IF_ERROR(open_link(emulated, s.get()));
  *servers = s.release();
  return success();
}

void close_servers(Servers* servers) {
  ConnectedServers* s = connected(servers);
  end_client(s);
  if (s->inquiry_link) s->inquiry_link->backend->close_all(s->inquiry_link);
  if (s->link != s->tcp) s->link->backend->close_all(s->link);
  kNet.close_all(s->tcp);
  platform::wipe(&s->key, sizeof s->key);
  delete s;
}

std::size_t servers_need(const Servers& servers, const Settings& settings) {
  const ConnectedServers& s = connected(servers);
  return client_need(settings, WireFormat::rgb888, static_cast<std::uint32_t>(s.addresses.size()), light_options(s));
}

Status start_client(Servers* servers, Renderer* renderer, bool small_pixels, bool dither) {
  ConnectedServers* s = connected(servers);
  end_client(s);
  ClientOptions options;
  options.format = wire_format(small_pixels);
  options.dither = dither;
  options.wish = wish_of(s->options);
  options.cost_per_device_pixel = s->options.energy_pixel;
  options.cost_per_byte = s->options.energy_byte;
  options.cost_per_megabyte = s->options.price;
  options.device_share = s->options.device_share;
  options.pace = renderer->pace;
  if (s->emulated) options.decode = {s->emulated->decode_pixel_ns, s->emulated->decode_byte_ns};
  options.has_scene = !s->is_thin;
  options.check_count = s->options.verify;
  options.near_lossless = s->options.near_lossless;
  if (s->options.coarse_first) options.coarse_after_ns = kLongFrameNs;
  options.light = light_options(*s);
  options.light.indirect = renderer->settings.indirect;
  if (s->is_thin && s->options.split != "rows")
    print_line(nullptr, "frames are shared by rows, not by effect: the scene does not fit on this device");
  options.entropy = platform::random_bytes;
  options.log = print_line;
  s->totals = ServersTotals();
  s->last = FrameShare();
  RETURN_IF_ERROR(open_client_link(s, &renderer->memory.frame));
  s->started = true;
  RETURN_IF_ERROR(make_client(options, renderer->settings, s->scene, s->client_link ? s->client_link : s->link,
                              s->addresses.data(), static_cast<std::uint32_t>(s->addresses.size()),
                              &renderer->memory.frame, &s->client));
  for (std::uint32_t i = 0; i < s->client.server_count; ++i)
    s->client.servers[i].overture.lied = s->client.servers[i].overture.told = s->lied[i];
  return success();
}

void stop_client(Servers* servers) { end_client(connected(servers)); }

Status begin_frame(Servers* servers, Renderer* renderer, double seconds) {
  return begin_frame(renderer, &connected(servers)->client, seconds);
}

bool advance_frame(Servers* servers, Renderer* renderer, std::uint64_t slice_ns, const std::atomic<bool>* stop) {
  ConnectedServers* s = connected(servers);
  CHECK(s->started);
  if (!advance_frame(renderer, &s->client, client_now_ns(s->client) + slice_ns, stop)) return false;
  const FrameShare& share = s->client.share;
  ServersTotals* t = &s->totals;
  s->last = share;
  ++t->frames;
  t->device_rows += share.device_rows, t->device_pixels += share.device_pixels;
  t->unchanged_frames += share.unchanged;
  for (std::uint32_t rows : share.server_rows) t->server_rows += rows;
  t->bytes_in += share.bytes_in, t->bytes_out += share.bytes_out;
  for (std::uint32_t checked : share.checked) t->checked += checked;
  t->lies += share.lies;
  t->effect_frames += share.by_effect, t->lit_frames += share.has_light, t->light_bytes += share.light_bytes;
  if (share.local_ns > 0) t->local_ns += share.local_ns, t->known_ns += share.measured_ns;
  return true;
}

void tend_client(Servers* servers) { advance_client(&connected(servers)->client, 0); }

// True if servers were asked for rows of a picture and sent none: they may send none of the next one, either.
bool gave_nothing(const FrameShare& share) {
  auto some = [](std::uint32_t count) { return count > 0; };
  return std::any_of(std::begin(share.row_end), std::end(share.row_end), some) &&
         std::none_of(std::begin(share.server_rows), std::end(share.server_rows), some);
}

// Servers count as in use once one has passed its overture, since a refined picture shows sooner than a complete one.
ServersState state_of(const Servers& servers) {
  const ConnectedServers& s = connected(servers);
  const Client& client = s.client;
  ServersState state;
  state.in_use = s.is_thin ||
                 std::any_of(client.servers, client.servers + client.server_count,
                             [](const RemoteServer& server) { return server.overture.phase >= ServerPhase::probing; });
  state.cut_off = is_cut_off(client);
  state.disputed = client.verifier.disputed;
  state.rows_done = client.picture.merge.row_count_done;
  const FrameOutlook outlook = outlook_of(client);
  state.coarse_shown = client.coarse.shown;
  state.left_ns = outlook.left_ns, state.anew_ns = gave_nothing(s.last) ? 0 : outlook.anew_ns;
  return state;
}

MergedPicture merged_picture(const Servers& servers) {
  CHECK(connected(servers).started);
  const Client& client = connected(servers).client;
  WireFormat format = client.options.format;
  return {client.picture.pixels.data, static_cast<int>(client.settings.width * pixel_bytes(format)),
          format == WireFormat::rgb565 ? kRgb565 : kRgb888};
}

bool take_rows(Servers* servers, std::uint32_t* row_begin, std::uint32_t* row_end) {
  return take_merged_rows(&connected(servers)->client, row_begin, row_end);
}

void show_own_picture(Servers* servers, const Renderer& renderer) {
  const Client& client = connected(servers)->client;
  MergedPicture merged = merged_picture(*servers);
  int height = static_cast<int>(renderer.settings.height);
  pack_rows(renderer.image.data, static_cast<int>(renderer.settings.width), height, 0, height, display_of(renderer),
            merged.format, Rotation::none, client.options.dither, client.picture.pixels.data, merged.line_bytes);
}

void add_server_lines(const ConnectedServers& s, HudText* text) {
  const Client& client = s.client;
  const FrameShare& f = s.last;
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    const RemoteServer& server = client.servers[i];
    if (f.by_effect && server.overture.phase == ServerPhase::ready && f.row_end[i] == 0)
      add_hud_line(text, "%s light  %.1f kB", server.address.text, static_cast<double>(f.server_bytes[i]) * 1e-3);
    else if (server.overture.phase == ServerPhase::ready && f.row_end[i] > 0)
      add_hud_line(text, "%s rows %u-%u, sent %u  %.1f kB", server.address.text, f.row_begin[i], f.row_end[i] - 1,
                   f.server_rows[i], static_cast<double>(f.server_bytes[i]) * 1e-3);
    else
      add_hud_line(text, "%s %s", server.address.text,
                   server.overture.lied ? "sent wrong pixels" : phase_text(server.overture.phase));
  }
}

void add_share_lines(const ConnectedServers& s, HudText* text) {
  const Client& client = s.client;
  const FrameShare& f = s.last;
  if (is_cut_off(client)) add_hud_line(text, "no server answers: the picture is frozen");
  if (f.measured_ns > 0) {
    if (f.local_ns > 0)
      add_hud_line(text, "%.1f ms, predicted %.1f, alone %.1f: %.1f times", f.measured_ns * 1e-6, f.predicted_ns * 1e-6,
                   f.local_ns * 1e-6, f.local_ns / f.measured_ns);
    else if (s.is_thin)
      add_hud_line(text, "%.1f ms  all by servers", f.measured_ns * 1e-6);
    else if (f.by_effect)
      add_hud_line(text, f.has_light ? "%.1f ms  shared by effect, light from %u frames ago" : "%.1f ms  no light yet",
                   f.measured_ns * 1e-6, f.light_age);
    else
      add_hud_line(text, "%.1f ms  device alone so far", f.measured_ns * 1e-6);
    const char* device = client.options.pace.device ? client.options.pace.device : "device";
    add_hud_line(text, "%s %u rows  %.1f kB in  %.1f kB out", device, f.device_rows,
                 static_cast<double>(f.bytes_in) * 1e-3, static_cast<double>(f.bytes_out) * 1e-3);
  }
  add_server_lines(s, text);
  if (client.verifier.disputed) add_hud_line(text, "servers disagree: the picture may be wrong");
  std::uint64_t checked = 0;
  double caught = 1;
  for (std::uint32_t i = 0; i < client.server_count; ++i) {
    checked += f.checked[i];
    if (f.server_rows[i] > 0) caught = std::min(caught, client.servers[i].checks.caught_row_last);
  }
  if (checked > 0)
    add_hud_line(text, "%llu %s checked: finds a wrong row with %.3g %%", static_cast<unsigned long long>(checked),
                 s.is_thin ? "rows" : "pixels", 100 * caught);
}

void write_lines(const Servers& servers, bool servers_only, HudText* text) {
  if (servers_only)
    add_server_lines(connected(servers), text);
  else
    add_share_lines(connected(servers), text);
}

ServersTotals totals_of(const Servers& servers) {
  const ConnectedServers& s = connected(servers);
  ServersTotals totals = s.totals;
  totals.checks_rows = s.is_thin;
  const ClientLight& light = s.client.light;
  const EffectModel& m = light.model;
  totals.effect_ns = light.effect_ns, totals.rows_ns = light.rows_ns;
  totals.effect_times = {value_or(m.prepare_ns, 0), value_or(m.device_ns, 0), value_or(m.server_ns, 0),
                         value_or(m.transfer_ns, 0), value_or(m.add_ns, 0)};
  totals.caught_row = 1;
  for (const RemoteServer& server : s.client.servers)
    if (server.checks.rows > 0 && !server.overture.lied)
      totals.caught_row = std::min(totals.caught_row, server.checks.caught_row);
  return totals;
}

}  // namespace

const ServersBackend kRenderServers = {open_servers,
                                       close_servers,
                                       servers_need,
                                       open_scene_or_leave_it,
                                       stop_opening,
                                       scene_triangle_count,
                                       list_offered_scenes,
                                       start_client,
                                       stop_client,
                                       begin_frame,
                                       advance_frame,
                                       tend_client,
                                       state_of,
                                       merged_picture,
                                       take_rows,
                                       show_own_picture,
                                       write_lines,
                                       totals_of};

ConnectedServers::ConnectedServers() : Servers{&kRenderServers} {}

std::size_t client_tls_need(const ConnectedServers& s) {
  return s.options.key.empty() ? 0 : encrypted_link_need(static_cast<int>(s.addresses.size()));
}

void end_client(ConnectedServers* servers) {
  for (std::uint32_t i = 0; servers->started && i < servers->client.server_count; ++i)
    servers->lied[i] = servers->client.servers[i].overture.lied;
  if (servers->started) close_client(&servers->client);
  if (servers->client_link) servers->client_link->backend->close_all(servers->client_link);
  servers->client_link = nullptr;
  servers->started = false;
}

}  // namespace pocketray
