#include "motion_rig.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "desktop/split_report/virtual_world.h"
#include "engine/frame.h"
#include "present/pack.h"
#include "remote/client/servers.h"
#include "support/scripted_client.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kSecond = 1'000'000'000, kTurnNs = kSecond / 2;
constexpr std::uint64_t kTurnAt = 5 * kSecond, kSettleNs = 2 * kSecond, kRestNs = 3 * kSecond;
constexpr std::uint64_t kShowNs = 2'000'000;  // to copy a page and show it

// What the screen, the buttons and the clock of the one device read.
struct Device {
  VirtualWorld* world = nullptr;
  Viewer* viewer = nullptr;
  MotionResult* result = nullptr;
  std::vector<platform::Event> script;
  std::size_t events_taken = 0;
  std::uint64_t begin_ns = 0, turn_end_ns = 0, shown_ns = 0;
  std::uint32_t frames_finished = 0, frames_dropped = 0, drops_in_a_row = 0;
  bool counts = false;
  std::uint64_t silent_from_ns = 0, silent_until_ns = 0;
  Server* silent = nullptr;
  unsigned char* page = nullptr;
  int line_bytes = 0, height = 0;
};
Device* device;

std::uint64_t now_ns() { return world_now_ns(*device->world); }

void sleep_ns(std::uint64_t duration) { device->world->link->backend->poll(device->world->link, nullptr, 0, duration); }

const Clock kWorldClock = {now_ns, sleep_ns};

bool open_screen(const platform::ScreenOptions& options, platform::ScreenFormat* format, platform::Error*) {
  *format = platform::screen_format(options.width, options.height, 32, false);
  device->page = static_cast<unsigned char*>(options.memory);
  device->line_bytes = 4 * options.width, device->height = options.height;
  return true;
}

platform::Page begin_page() { return {device->page, device->line_bytes, 1}; }

// Counts the pictures shown and dropped since the last page.
void count_pictures(std::uint64_t now) {
  const Viewer& viewer = *device->viewer;
  MotionResult* r = device->result;
  if (viewer.frames_dropped > device->frames_dropped) {
    device->drops_in_a_row += viewer.frames_dropped - device->frames_dropped;
    if (device->counts) ++r->dropped, r->drops_in_a_row = std::max(r->drops_in_a_row, device->drops_in_a_row);
  }
  device->frames_dropped = viewer.frames_dropped;
  if (viewer.frames_finished == device->frames_finished) return;
  device->frames_finished = viewer.frames_finished, device->drops_in_a_row = 0;
  if (device->counts && device->shown_ns > 0 && now < device->turn_end_ns) {
    const double gap_ms = static_cast<double>(now - device->shown_ns) * 1e-6;
    r->gap_ms_max = std::max(r->gap_ms_max, gap_ms), r->gap_ms_mean += gap_ms;
    ++r->shown;
  }
  device->shown_ns = now;
}

void end_page(int, int) {
  sleep_ns(kShowNs);
  count_pictures(now_ns());
}

// A server that does nothing for a while.
void silence(std::uint64_t since_ns) {
  const bool silent = since_ns >= device->silent_from_ns && since_ns < device->silent_until_ns;
  if (silent == (device->silent != nullptr)) return;
  std::swap(device->silent, device->world->servers[0]);
}

bool poll_buttons(platform::Event* event) {
  const std::uint64_t since_ns = now_ns() - device->begin_ns;
  if (!device->counts && since_ns >= kTurnAt + kSettleNs) {
    device->counts = true;
    std::fill(std::begin(device->viewer->motion.ns_by_latency), std::end(device->viewer->motion.ns_by_latency), 0);
    device->viewer->motion.total_ns = 0;
  }
  silence(since_ns);
  if (device->events_taken == device->script.size()) return false;
  if (device->script[device->events_taken].time_ns > now_ns()) return false;
  *event = device->script[device->events_taken++];
  return true;
}

void close_screen() {}
bool is_usable() { return true; }

const platform::Backend kDevice = {"virtual", "nothing",    is_usable, open_screen, begin_page,
                                   end_page,  poll_buttons, now_ns,    sleep_ns,    close_screen};

void press(platform::Button button, bool down, std::uint64_t at_ns) {
  platform::Event event;
  event.type = down ? platform::EventType::button_down : platform::EventType::button_up;
  event.button = button, event.time_ns = device->begin_ns + at_ns;
  device->script.push_back(event);
}

void write_script(double turn_seconds) {
  const platform::Button buttons[] = {platform::Button::right, platform::Button::left};
  const int turns = static_cast<int>(turn_seconds * 1e9 / double(kTurnNs));
  std::uint64_t at_ns = kTurnAt;
  for (int i = 0; i < turns; ++i, at_ns += kTurnNs) {
    press(buttons[i % 2], true, at_ns);
    press(buttons[i % 2], false, at_ns + kTurnNs);
  }
  device->turn_end_ns = device->begin_ns + at_ns;
  platform::Event quit;
  quit.time_ns = device->turn_end_ns + kRestNs;
  device->script.push_back(quit);
}

}  // namespace

MotionResult run_motion(const MotionOptions& o) {
  MotionResult result;
  platform::NullLinkSettings line;
  line.bytes_per_second = o.bytes_per_second, line.latency_ns = o.round_trip_ns / 2;
  line.lost_per_million = o.lost_per_million, line.seed = o.seed;
  line.pipe_bytes = 1u << 18;
  VirtualWorld world;
  REQUIRE(open_world(line, builtin_store(), 1, &world).ok);
  ServerOptions server;
  server.client_memory_bytes = 16u << 20;
  server.pace.ns_per_pixel = o.server_ns;
  REQUIRE(start_server(&world, 0, server).ok);
  auto servers = std::make_unique<ConnectedServers>();
  servers->link = world.link;
  servers->addresses = world.addresses;
  servers->options.verify = 0, servers->options.coarse_first = o.coarse_first;

  Device screen;
  device = &screen;
  screen.world = &world, screen.result = &result;
  Viewer viewer;
  screen.viewer = &viewer;
  viewer.options.hud = viewer.hud = false;
  viewer.options.frame_count = o.frame_count, viewer.options.drops_frames = o.drops_frames;
  viewer.width = static_cast<int>(o.width), viewer.height = static_cast<int>(o.height);
  viewer.scene_path = "cornell";
  viewer.backend = &kDevice;
  std::vector<std::uint32_t> pages(2 * o.width * o.height);
  platform::ScreenOptions asked;
  asked.width = viewer.width, asked.height = viewer.height, asked.memory = pages.data();
  platform::ScreenFormat format;
  REQUIRE(open_screen(asked, &format, nullptr));
  viewer.format = {32, {16, 8}, {8, 8}, {0, 8}, {24, 8}};
  viewer.servers = servers.get();

  CommonOptions common;
  common.scene = "cornell", common.threads = 1, common.coherence = "off";
  common.settings["indirect"].choice = "ambient";  // the server's scene stores no radiosity
  common.size = std::to_string(o.width) + "x" + std::to_string(o.height);
  OpenScene opened;
  REQUIRE(open_scene_with(servers.get(), common, viewer_bytes, &opened).ok);
  Renderer* renderer = &opened.renderer;
  renderer->pace.ns_per_pixel = o.device_ns;
  renderer->pace.clock = &kWorldClock;
  REQUIRE(kRenderServers.start(servers.get(), renderer, false, false).ok);
  screen.begin_ns = now_ns();
  screen.silent_from_ns = static_cast<std::uint64_t>(o.silence_at * 1e9);
  screen.silent_until_ns = static_cast<std::uint64_t>((o.silence_at + o.silence_for) * 1e9);
  write_script(o.turn_seconds);
  bool again;
  REQUIRE(run_viewer(&viewer, renderer, &again).ok);
  silence(~std::uint64_t(0));
  result.motion = viewer.motion;
  result.frames_finished = viewer.frames_finished, result.frames_dropped = viewer.frames_dropped;
  if (result.shown > 0) result.gap_ms_mean /= result.shown;
  const std::size_t bytes = std::size_t(4) * o.width * o.height;
  result.screen.assign(screen.page, screen.page + bytes);
  renderer->pace = Pace();
  REQUIRE(render_frame(renderer, 0).ok);
  viewer.picture_merged = false;
  pack_rows(renderer->image.data, viewer.width, viewer.height, 0, viewer.height, display_of(*renderer), viewer.format,
            Rotation::none, false, screen.page, screen.line_bytes);
  result.own_screen.assign(screen.page, screen.page + bytes);
  kRenderServers.stop(servers.get());
  device = nullptr;
  return result;
}

}  // namespace pocketray
