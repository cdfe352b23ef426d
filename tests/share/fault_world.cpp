#include "fault_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "app/frame.h"
#include "app/server_state.h"
#include "base/rng.h"
#include "platform/link_pipe.h"
#include "present/pack.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

namespace pocketray {
namespace {

constexpr const char* kScene = "cube";
constexpr int kStreams = 40;
constexpr std::uint64_t kSilenceNs = 2'000 * kMs, kConnectNs = 500 * kMs;
constexpr std::uint64_t kRetryMinNs = 100 * kMs, kRetryMaxNs = 1'000 * kMs;
constexpr std::uint64_t kServerIdleNs = 4'000 * kMs;
// A lost connection is noticed, its place at the server is free again, the next try is due, the overture is over.
constexpr std::uint64_t kReturnNsMax = kSilenceNs + kServerIdleNs + 2 * kRetryMaxNs + 3 * kSilenceNs;
constexpr int kSizes[][2] = {{8, 8}, {16, 12}, {8, 40}};
constexpr double kSeconds[] = {0, 0.3, 0.7, 1.1};  // of the animation, one frame after the other

// The device's renderer and what its frames look like, for all sessions.
struct Device {
  std::unique_ptr<BuiltScene> built;
  std::unique_ptr<TestRenderer> renderer;
  std::map<int, std::vector<std::uint8_t>> pictures;
};

Device& device_of(const FaultPlan& plan) {
  static std::map<std::uint32_t, Device> devices;
  Device& device = devices[plan.width << 16 | plan.height];
  if (!device.renderer) {
    device.built = build_builtin(kScene);
    Settings settings;
    settings.width = plan.width, settings.height = plan.height;
    settings.memory_bytes = 8u << 20;
    device.renderer = make_renderer(device.built->scene, settings);
  }
  return device;
}

const std::vector<std::uint8_t>& picture_of(const FaultPlan& plan, int second) {
  Device& device = device_of(plan);
  bool small = plan.format == WireFormat::rgb565;
  std::vector<std::uint8_t>& pixels = device.pictures[second * 4 + small * 2 + plan.dither];
  if (!pixels.empty()) return pixels;
  Renderer* r = &device.renderer->renderer;
  REQUIRE(render_frame(r, kSeconds[second]).ok);
  int width = static_cast<int>(plan.width), height = static_cast<int>(plan.height);
  int line_bytes = width * static_cast<int>(pixel_bytes(plan.format));
  pixels.resize(static_cast<std::size_t>(line_bytes) * plan.height);
  pack_rows(r->image.data, width, height, 0, height, r->exposure, small ? kRgb565 : kRgb888, Rotation::none,
            plan.dither, pixels.data(), line_bytes);
  return pixels;
}

struct Random {
  std::uint64_t state;
  std::uint64_t below(std::uint64_t n) { return platform::random_u64(&state) % n; }
  double real() { return static_cast<double>(platform::random_u64(&state) >> 11) * 0x1p-53; }
  // Every order of magnitude alike.
  double scale(double low, double high) { return low * std::pow(high / low, real()); }
};

struct World {
  FaultPlan plan;
  platform::Link* link = nullptr;
  Server* servers[3] = {};
  bool frozen[3] = {};
  platform::LinkAddress addresses[3];
  Client client;
  std::vector<std::string> log;
  std::uint64_t frame_begin_ns = 0;
  int frame = 0;
  bool disturbed = false;  // something has gone wrong in this frame
  std::uint64_t disturbed_ns = 0;
  int faults_struck = 0;
  bool done[kSessionEventsMax] = {};
  std::vector<platform::LinkWait> waits;

  std::uint64_t elapsed() const { return platform::null_link_record(link).elapsed_ns; }
  double local_ns() const { return plan.device_ns * plan.width * plan.height; }
};
World* world = nullptr;

// The world as whoever is no device sees it.
struct Outside {
  const platform::LinkBackend* backend = world->link->backend;
  Outside() { world->link->backend = &platform::kNullLink; }
  ~Outside() { world->link->backend = backend; }
};

void start(std::uint32_t i) {
  Outside outside;
  ServerOptions o;
  o.client_memory_bytes = kSessionBytesMin;
  o.client_count_max = 4;
  o.pace.ns_per_pixel = world->plan.server_ns[i];
  o.idle_timeout_ns = kServerIdleNs;
  o.message_timeout_ns = o.stall_timeout_ns = kSilenceNs;
  Status status = open_server(o, builtin_store(), world->link, world->addresses[i], &world->servers[i]);
  REQUIRE_MESSAGE(status.ok, status.message);
  platform::Error error;
  REQUIRE(platform::kNullLink.resolve(server_address(*world->servers[i]), &world->addresses[i], &error));
}

void kill(std::uint32_t i) {
  Outside outside;
  Server* server = world->servers[i];
  if (!server) return;
  for (Session& s : server->sessions)
    if (s.phase != SessionPhase::unused) {
      platform::kNullLink.close(world->link, s.stream);
      s.phase = SessionPhase::unused;
    }
  close_server(server);
  world->servers[i] = nullptr;
}

void happen(const PlannedEvent& event) {
  std::uint32_t i = event.server;
  world->disturbed = true;
  world->disturbed_ns = world->elapsed();
  if (event.event == ServerEvent::freeze) world->frozen[i] = true;
  if (event.event == ServerEvent::kill) kill(i);
  if (event.event == ServerEvent::end) {
    Outside outside;
    close_server(world->servers[i]);
    world->servers[i] = nullptr;
  }
}

// Those before the frame, or within it.
void look_for_events(bool before) {
  const FaultPlan& plan = world->plan;
  for (int i = 0; i < plan.event_count; ++i) {
    const PlannedEvent& event = plan.events[i];
    if (world->done[i] || event.frame != world->frame || (event.at > 0) == before) continue;
    double passed = static_cast<double>(world->elapsed() - world->frame_begin_ns);
    if (!before && passed < event.at * world->local_ns()) continue;
    world->done[i] = true;
    happen(event);
  }
}

void bring_back(std::uint32_t i) {
  world->frozen[i] = false;
  if (!world->servers[i]) start(i);
}

void step_servers() {
  Outside outside;
  for (std::uint32_t i = 0; i < world->plan.server_count; ++i)
    if (world->servers[i] && !world->frozen[i]) step_server(world->servers[i], 0);
}

// While the device waits, the others go on.
int poll_world(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  std::uint64_t begin = world->elapsed();
  for (;;) {
    look_for_events(false);
    step_servers();
    std::uint64_t passed = world->elapsed() - begin, left = passed < timeout_ns ? timeout_ns - passed : 0;
    std::uint64_t next = std::min<std::uint64_t>(left, 100 * kMs);
    world->waits.assign(waits, waits + wait_count);
    for (std::uint32_t i = 0; i < world->plan.server_count; ++i) {
      Server* server = world->servers[i];
      if (!server || world->frozen[i]) continue;
      Outside outside;
      next = std::min(next, std::max<std::uint64_t>(200, work_due_ns(server)));
      world->waits.insert(world->waits.end(), server->waits.begin(), server->waits.end());
    }
    for (int i = 0; i < world->plan.event_count; ++i) {
      const PlannedEvent& event = world->plan.events[i];
      double due = event.at * world->local_ns() - static_cast<double>(world->elapsed() - world->frame_begin_ns);
      if (!world->done[i] && event.frame == world->frame && due > 0)
        next = std::min(next, static_cast<std::uint64_t>(due) + 1);
    }
    platform::kNullLink.poll(link, world->waits.data(), static_cast<int>(world->waits.size()), next);
    std::copy(world->waits.begin(), world->waits.begin() + wait_count, waits);
    int ready = 0;
    for (int i = 0; i < wait_count; ++i) ready += waits[i].can_read || waits[i].can_write;
    if (ready > 0 || left <= next) return ready;
  }
}

platform::LinkBackend world_backend() {
  platform::LinkBackend backend = platform::kNullLink;
  backend.poll = poll_world;
  return backend;
}
const platform::LinkBackend kWorldLink = world_backend();

void note_faults() {
  int struck = platform::null_link_record(world->link).faults_struck;
  if (struck == world->faults_struck) return;
  world->faults_struck = struck;
  world->disturbed = true;
  world->disturbed_ns = world->elapsed();
}

std::string fail(const std::string& what, double value = 0) {
  char text[60];
  std::snprintf(text, sizeof text, " (%.4g)", value);
  return "frame " + std::to_string(world->frame) + ": " + what + text;
}

std::string phases() {
  std::string text;
  for (std::uint32_t i = 0; i < world->plan.server_count; ++i)
    text += std::string(i ? ", " : "") + phase_text(world->client.servers[i].phase);
  for (const std::string& line : world->log) text += "\n    " + line;
  return text;
}

// One frame, against the device's own and its time.
std::string run_frame(SessionResult* result) {
  const FaultPlan& plan = world->plan;
  int second = world->frame % static_cast<int>(std::size(kSeconds));
  std::size_t lines_before = world->log.size();
  const std::vector<std::uint8_t>& expected = picture_of(plan, second);
  world->disturbed = false;
  look_for_events(true);
  world->frame_begin_ns = world->elapsed();
  bool complete = false;
  Renderer* r = &device_of(plan).renderer->renderer;
  if (!render_shared_frame(r, &world->client, kSeconds[second], nullptr, &complete).ok || !complete)
    return fail("is not complete");
  double ns = static_cast<double>(world->elapsed() - world->frame_begin_ns), row_ns = plan.device_ns * plan.width;
  note_faults();
  const Array<std::uint8_t>& pixels = world->client.pixels;
  if (!std::equal(pixels.begin(), pixels.end(), expected.begin(), expected.end()))
    return fail("is not the device's own");
  // What has gone wrong is noticed when an answer is overdue.
  bool calm =
      !world->disturbed && (world->disturbed_ns == 0 || world->frame_begin_ns > world->disturbed_ns + kSilenceNs);
  for (std::uint32_t i = 0; i < plan.server_count; ++i) calm = calm && world->servers[i] && !world->frozen[i];
  // The device may wait for late rows as long as one would take it, and look up a row later.
  double ratio = (ns - 2 * row_ns) / world->local_ns();
  ++result->frames, result->frames_disturbed += !calm;
  double* worst = calm ? &result->worst_calm : &result->worst_disturbed;
  *worst = std::max(*worst, ratio);
  if (ratio > (calm ? 1.05 : 2)) return fail(calm ? "is late" : "is late, and something went wrong in it", ratio);
  if (world->log.size() > lines_before + 2 * plan.server_count) return fail("is reported too often");
  return "";
}

// Whether a server is in use. One whose first rows take most of a frame has no part in frames: it is asked for some in
// each, and they come too late.
bool is_back(std::uint32_t i) {
  const FaultPlan& plan = world->plan;
  ServerPhase phase = world->client.servers[i].phase;
  double rows_ns = 2 * static_cast<double>(plan.line.latency_ns + plan.line.jitter_ns) +
                   plan.server_count * (plan.server_ns[i] * plan.width * 4 + 2e6);
  return phase == ServerPhase::ready ||
         (phase == ServerPhase::probing && rows_ns > world->client.share.measured_ns / 4);
}

// Lines come in turns: lost, in use again.
std::string check_log(SessionResult* result) {
  for (std::uint32_t i = 0; i < world->plan.server_count; ++i) {
    bool lost = false;
    for (const std::string& line : world->log) {
      if (line.find(world->addresses[i].text) == std::string::npos) continue;
      bool back = line.find("in use again") != std::string::npos;
      if (back != lost) return fail("is reported out of turn: " + line);
      lost = !back;
      result->losses += lost;
    }
    if (lost && world->client.servers[i].phase == ServerPhase::ready)
      return fail("a server that is back is not reported so");
  }
  return "";
}

std::string run(SessionResult* result) {
  const FaultPlan& plan = world->plan;
  for (world->frame = 0; world->frame < kFaultFrames; ++world->frame) {
    for (int i = 0; i < plan.event_count; ++i)
      if (world->done[i] && plan.events[i].back_frame == world->frame) bring_back(plan.events[i].server);
    std::string failure = run_frame(result);
    if (!failure.empty()) return failure;
    if (world->frame % 3 == 2) advance_client(&world->client, static_cast<std::uint64_t>(world->local_ns()));
  }
  // Nothing goes wrong any more: all are back within a bounded time.
  for (platform::NullFault& fault : world->plan.faults) fault.connection = 1 << 30;
  for (std::uint32_t i = 0; i < plan.server_count; ++i) bring_back(i);
  auto all_ready = [&] {
    for (std::uint32_t i = 0; i < plan.server_count; ++i)
      if (!is_back(i)) return false;
    return true;
  };
  std::uint64_t begin = world->elapsed();
  // A connection of which the device does not know yet that it is dead is found out meanwhile.
  std::uint64_t quiet_ns = kSilenceNs + 600 * kMs;
  while (!all_ready() || world->elapsed() - begin < quiet_ns) {
    if (!all_ready() && world->elapsed() - begin > kReturnNsMax + 10 * static_cast<std::uint64_t>(world->local_ns()))
      return fail("not all servers are in use again: " + phases());
    std::string failure = run_frame(result);
    if (!failure.empty()) return failure;
    ++world->frame;
    for (std::uint64_t until = world->elapsed() + 100 * kMs; world->elapsed() < until;)
      advance_client(&world->client, until - world->elapsed());
    if (!all_ready()) result->return_ns = world->elapsed() - begin;
  }
  return check_log(result);
}

}  // namespace

FaultPlan draw_faults(std::uint64_t seed) {
  Random random = {platform::random_u64(&seed)};
  FaultPlan plan = {};
  const int* size = kSizes[random.below(std::size(kSizes))];
  plan.width = static_cast<std::uint32_t>(size[0]), plan.height = static_cast<std::uint32_t>(size[1]);
  plan.server_count = 1 + static_cast<std::uint32_t>(random.below(3));
  plan.format = random.below(2) ? WireFormat::rgb565 : WireFormat::rgb888;
  plan.dither = random.below(2);
  double frame_ns = random.scale(25e6, 400e6);
  plan.device_ns = frame_ns / (plan.width * plan.height);
  for (double& ns : plan.server_ns) ns = plan.device_ns * random.scale(0.02, 2);
  plan.device_share = random.below(4) ? -1 : random.real();
  plan.line.clock_step_ns = 20;
  plan.line.bytes_per_second = random.below(4) ? static_cast<std::uint64_t>(random.scale(100e3, 20e6)) : 0;
  plan.line.latency_ns = random.below(4) ? static_cast<std::uint64_t>(random.scale(1e4, 2e7)) : 0;
  plan.line.jitter_ns = random.below(2) ? static_cast<std::uint64_t>(random.scale(1e3, 5e6)) : 0;
  plan.line.pipe_bytes = 24576;
  plan.line.seed = random.below(1u << 30) + 1;
  plan.line.fault_count = static_cast<int>(random.below(kSessionFaultsMax + 1));
  // Half of them within the overture's small messages.
  std::uint64_t byte_count = random.below(2) ? 200 : 30'000;
  platform::null_link_draw_faults(random.below(~0u), kFaultyConnections, byte_count, plan.faults,
                                  plan.line.fault_count);
  plan.event_count = static_cast<int>(random.below(kSessionEventsMax + 1));
  for (int i = 0; i < plan.event_count; ++i) {
    PlannedEvent* e = &plan.events[i];
    e->event = static_cast<ServerEvent>(random.below(3));
    e->server = static_cast<std::uint32_t>(random.below(plan.server_count));
    e->frame = static_cast<int>(random.below(kFaultFrames));
    e->at = e->event == ServerEvent::end || random.below(4) == 0 ? 0 : random.real();
    e->back_frame = e->frame + 1 + static_cast<int>(random.below(4));
  }
  return plan;
}

std::string plan_text(const FaultPlan& plan) {
  char text[300];
  std::snprintf(
      text, sizeof text,
      "%ux%u %s%s, device %.0f ns a pixel, share %.2f, servers %u: %.0f %.0f %.0f, %.0f kB/s, latency %.2f ms, "
      "jitter %.2f ms",
      plan.width, plan.height, plan.format == WireFormat::rgb565 ? "rgb565" : "rgb888", plan.dither ? " dithered" : "",
      plan.device_ns, plan.device_share, plan.server_count, plan.server_ns[0], plan.server_ns[1], plan.server_ns[2],
      static_cast<double>(plan.line.bytes_per_second) / 1e3, static_cast<double>(plan.line.latency_ns) / 1e6,
      static_cast<double>(plan.line.jitter_ns) / 1e6);
  std::string all = text;
  for (int i = 0; i < plan.line.fault_count; ++i) {
    const platform::NullFault& f = plan.faults[i];
    std::snprintf(text, sizeof text, "; %s in connection %d at byte %u %s the device", link_fault_name(f.fault),
                  f.connection, static_cast<unsigned>(f.at_byte), f.to_device ? "to" : "from");
    all += text;
  }
  for (int i = 0; i < plan.event_count; ++i) {
    const PlannedEvent& e = plan.events[i];
    static const char* const kNames[] = {"dies", "ends", "freezes"};
    std::snprintf(text, sizeof text, "; server %u %s in frame %d at %.2f, back before %d", e.server,
                  kNames[static_cast<int>(e.event)], e.frame, e.at, e.back_frame);
    all += text;
  }
  return all;
}

SessionResult run_fault_session(std::uint64_t seed) {
  SessionResult result;
  World here;
  world = &here;
  here.plan = draw_faults(seed);
  FaultPlan& plan = here.plan;
  plan.line.faults = plan.faults;
  static std::vector<std::max_align_t> link_memory;
  platform::LinkOptions link_options;
  link_options.memory_bytes = null_link_need(kStreams, plan.line);
  link_memory.resize(link_options.memory_bytes / sizeof(std::max_align_t) + 1);
  link_options.memory = link_memory.data();
  link_options.stream_count_max = kStreams;
  platform::Error error;
  here.link = null_link_open(link_options, plan.line, &error);
  REQUIRE_MESSAGE(here.link != nullptr, error.text);
  for (std::uint32_t i = 0; i < plan.server_count; ++i) {
    REQUIRE(platform::kNullLink.resolve(":0", &here.addresses[i], &error));
    start(i);
  }
  here.link->backend = &kWorldLink;
  Settings settings = device_of(plan).renderer->renderer.settings;
  ClientOptions o;
  o.format = plan.format, o.dither = plan.dither, o.device_share = plan.device_share;
  o.pace.ns_per_pixel = plan.device_ns;
  o.connect_timeout_ns = kConnectNs, o.silence_timeout_ns = o.prepare_timeout_ns = kSilenceNs;
  o.retry_ns_min = kRetryMinNs, o.retry_ns_max = kRetryMaxNs;
  o.log = [](void*, const char* line) { world->log.push_back(line); };
  std::vector<std::uint8_t> memory(client_need(settings, o.format, plan.server_count) + kArenaAlignment);
  Arena arena = make_arena("client", memory.data(), memory.size());
  Status status = make_client(o, settings, builtin_hash(kScene), here.link, here.addresses, plan.server_count, &arena,
                              &here.client);
  REQUIRE_MESSAGE(status.ok, status.message);

  result.failure = run(&result);
  result.faults_struck = here.faults_struck;
  for (int i = 0; i < plan.line.fault_count; ++i) ++result.struck[static_cast<int>(plan.faults[i].fault)];

  // No server keeps a client that is gone.
  close_client(&here.client);
  for (std::uint32_t i = 0; i < plan.server_count; ++i) bring_back(i);
  for (std::uint64_t until = here.elapsed() + kServerIdleNs + kSilenceNs + 200 * kMs; here.elapsed() < until;)
    kWorldLink.poll(here.link, nullptr, 0, until - here.elapsed());
  for (std::uint32_t i = 0; i < plan.server_count; ++i)
    if (result.failure.empty() && server_client_count(*here.servers[i]) > 0)
      result.failure = fail("leaves a session behind");
  for (std::uint32_t i = 0; i < plan.server_count; ++i) kill(i);
  platform::kNullLink.close_all(here.link);
  world = nullptr;
  return result;
}

}  // namespace pocketray
