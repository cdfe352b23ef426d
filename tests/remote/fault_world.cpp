#include "fault_world.h"

#include <algorithm>
#include <map>

#include "engine/frame.h"
#include "engine/row_costs.h"
#include "platform/null/net/null_state.h"
#include "present/pack.h"
#include "remote/server/state.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"

namespace pocketray {
namespace {

constexpr int kStreams = 128;
constexpr std::uint64_t kNeighbourStepNs = 10 * kMs;
constexpr double kStuckTimes = 10;           // in units of the device's time for a frame,
constexpr std::uint32_t kVirtualLights = 4;  // few, as every pixel of every server traces rays to them
constexpr double kOwnLightPart = 0.6;        // of a pixel's time, without them
constexpr int kStuckReads = 1000;            // or reads between two waits: enough to test a flood

// The device's renderer and reference pictures, shared by all sessions.
struct Device {
  std::unique_ptr<BuiltScene> built;
  std::unique_ptr<TestRenderer> renderer, whole;  // coherent, and for the reference pictures
  std::map<int, std::vector<std::uint8_t>> pictures;
};

Device& device_of(const FaultPlan& plan) {
  static std::map<std::pair<std::uint32_t, bool>, Device> devices;
  const bool is_lit = plan.split != SplitKind::rows;
  Device& device = devices[{plan.width << 16 | plan.height, is_lit}];
  if (!device.renderer) {
    device.built = build_builtin(kFaultScene);
    Settings settings;
    settings.width = plan.width, settings.height = plan.height;
    settings.memory_bytes = 8u << 20;
    if (is_lit)
      settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = kVirtualLights;
    device.whole = make_renderer(device.built->scene, settings);
    settings.coherence = CoherenceMode::automatic;
    device.renderer = make_renderer(device.built->scene, settings);
    REQUIRE(device.renderer->renderer.history.state.planned);
  }
  return device;
}

}  // namespace

const std::vector<std::uint8_t>& device_picture(const FaultPlan& plan, int second, Lighting lighting) {
  Device& device = device_of(plan);
  bool small = plan.format == WireFormat::rgb565;
  const int kind = static_cast<int>(lighting);
  std::vector<std::uint8_t>& pixels = device.pictures[kind * 64 + second * 4 + small * 2 + plan.dither];
  if (!pixels.empty()) return pixels;
  Renderer* renderer = &device.whole->renderer;
  if (plan.split != SplitKind::rows) {
    Settings settings = renderer->settings;
    settings.indirect = lighting == Lighting::asked ? indirect_choice(Effect::instant_radiosity)
                        : lighting == Lighting::own ? own_indirect(renderer->scene)
                                                    : IndirectChoice::none;
    REQUIRE(change_settings(renderer, settings).ok);
  }
  REQUIRE(render_frame(renderer, kFaultSeconds[second]).ok);
  int width = static_cast<int>(plan.width), height = static_cast<int>(plan.height);
  int line_bytes = width * static_cast<int>(pixel_bytes(plan.format));
  pixels.resize(static_cast<std::size_t>(line_bytes) * plan.height);
  pack_rows(renderer->image.data, width, height, 0, height, display_of(*renderer), small ? kRgb565 : kRgb888,
            Rotation::none, plan.dither, pixels.data(), line_bytes);
  return pixels;
}

Renderer* device_renderer(const FaultPlan& plan) { return &device_of(plan).renderer->renderer; }

namespace {

FaultWorld* world = nullptr;

// The world as seen by everyone but the device.
struct Outside {
  const platform::LinkBackend* backend = world->link->backend;
  Outside() { world->link->backend = &platform::kNullLink; }
  ~Outside() { world->link->backend = backend; }
};

const std::vector<std::uint8_t>& picture_at(double seconds) {
  for (int i = 0; i < static_cast<int>(std::size(kFaultSeconds)); ++i)
    if (kFaultSeconds[i] == seconds) return device_picture(world->plan, i);
  FAIL("a frame of a time that nobody asked for");
  return device_picture(world->plan, 0);
}

void start(std::uint32_t i) {
  Outside outside;
  Place* place = &world->places[i];
  const FaultPlan& plan = world->plan;
  if (plan.malice[i] != Malice::none && !world->peace) {
    HostileSettings settings = {plan.malice[i], plan.server_ns[i], kSilenceNs, plan.seed + i + 1, picture_at};
    place->hostile = open_hostile_server(world->link, place->address, settings);
    return;
  }
  ServerOptions o;
  o.client_memory_bytes = plan.split == SplitKind::rows ? kSessionBytesMin : 2 * kSessionBytesMin;
  o.client_count_max = 4;
  o.pace.ns_per_pixel = plan.server_ns[i];
  o.row_costs = plan.row_costs;
  o.idle_timeout_ns = kServerIdleNs;
  o.message_timeout_ns = o.stall_timeout_ns = kSilenceNs;
  Status status = open_server(o, builtin_store(), world->link, place->address, &place->server);
  REQUIRE_MESSAGE(status.ok, status.message);
}

void kill(std::uint32_t i) {
  Outside outside;
  Place* place = &world->places[i];
  if (place->hostile) close_hostile_server(place->hostile.get());
  place->hostile.reset();
  Server* server = place->server;
  if (!server) return;
  for (Session& s : server->sessions)
    if (s.phase != SessionPhase::unused) {
      platform::kNullLink.close(world->link, s.messages.stream);
      s.phase = SessionPhase::unused;
    }
  close_server(server);
  place->server = nullptr;
}

void happen(const PlannedEvent& event) {
  Place* place = &world->places[event.server];
  world->disturbed = true;
  world->disturbed_ns = world->elapsed();
  if (event.event == ServerEvent::freeze) place->frozen = true;
  if (event.event == ServerEvent::kill || place->hostile) return kill(event.server);
  if (event.event == ServerEvent::end) {
    Outside outside;
    close_server(place->server);
    place->server = nullptr;
    world->lost_ns += world->elapsed() - world->disturbed_ns;  // nobody else runs while it says goodbye
  }
}

}  // namespace

void look_for_events(bool before) {
  const FaultPlan& plan = world->plan;
  for (int i = 0; i < plan.event_count; ++i) {
    const PlannedEvent& event = plan.events[i];
    if (world->done[i] || event.frame != world->frame || (event.at > 0) == before) continue;
    double passed = static_cast<double>(world->elapsed() - world->frame_begin_ns);
    if (!before && passed < event.at * static_cast<double>(world->local_ns)) continue;
    world->done[i] = true;
    happen(event);
  }
}

void bring_back(std::uint32_t i) {
  Place* place = &world->places[i];
  place->frozen = false;
  if (world->peace && place->hostile) kill(i);
  if (!place->is_there()) start(i);
}

namespace {

void step_others() {
  Outside outside;
  for (std::uint32_t i = 0; i < world->plan.server_count; ++i) {
    Place* place = &world->places[i];
    if (place->frozen) continue;
    if (place->server) step_server(place->server, 0);
    if (place->hostile) step_hostile_server(place->hostile.get());
  }
  if (world->peace || world->plan.neighbour_count == 0 || world->elapsed() < world->neighbours_due_ns) return;
  world->neighbours_due_ns = world->elapsed() + kNeighbourStepNs;
  for (int i = 0; i < world->plan.neighbour_count; ++i) {
    HostileClient* neighbour = &world->neighbours[i];
    step_hostile_client(world->link, world->places[neighbour->is.server].address, neighbour);
  }
}

// Time until another party has something to do.
std::uint64_t others_due_ns() {
  Outside outside;
  std::uint64_t next = world->plan.neighbour_count > 0 && !world->peace ? kNeighbourStepNs : 100 * kMs;
  for (std::uint32_t i = 0; i < world->plan.server_count; ++i) {
    Place* place = &world->places[i];
    if (place->frozen || !place->is_there()) continue;
    if (place->hostile) {
      next = std::min(next, std::max<std::uint64_t>(200, hostile_due_ns(*place->hostile)));
      add_hostile_waits(*place->hostile, &world->waits);
    } else {
      next = std::min(next, std::max<std::uint64_t>(200, work_due_ns(place->server)));
      world->waits.insert(world->waits.end(), place->server->waits.begin(), place->server->waits.end());
    }
  }
  for (int i = 0; i < world->plan.event_count; ++i) {
    const PlannedEvent& event = world->plan.events[i];
    double due =
        event.at * static_cast<double>(world->local_ns) - static_cast<double>(world->elapsed() - world->frame_begin_ns);
    if (!world->done[i] && event.frame == world->frame && due > 0)
      next = std::min(next, static_cast<std::uint64_t>(due) + 1);
  }
  return next;
}

// The device cannot know when its clock was set back: at most since its last poll.
void note_clock(std::uint64_t looked_ns) {
  std::uint64_t set_back_ns = static_cast<platform::null_link::NullLink*>(world->link)->set_back_ns;
  if (set_back_ns != world->set_back_ns) world->lost_ns += world->elapsed() - looked_ns;
  world->set_back_ns = set_back_ns;
}

// While the device waits, the others run.
int poll_world(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  std::uint64_t begin = world->elapsed();
  world->reads = 0;
  for (;;) {
    look_for_events(false);
    step_others();
    std::uint64_t passed = world->elapsed() - begin, left = passed < timeout_ns ? timeout_ns - passed : 0;
    world->waits.assign(waits, waits + wait_count);
    std::uint64_t next = std::min(left, others_due_ns());
    platform::kNullLink.poll(link, world->waits.data(), static_cast<int>(world->waits.size()), next);
    std::copy(world->waits.begin(), world->waits.begin() + wait_count, waits);
    int ready = 0;
    for (int i = 0; i < wait_count; ++i) ready += waits[i].can_read || waits[i].can_write;
    if (ready > 0 || left <= next) {
      note_clock(begin);
      return ready;
    }
  }
}

// Reading takes device time, during which a flood continues; one that has held the device for long stops.
platform::LinkResult read_world(platform::Link* link, int stream, void* bytes, std::size_t byte_count_max,
                                std::size_t* byte_count, platform::Error* error) {
  platform::LinkResult result = platform::kNullLink.read(link, stream, bytes, byte_count_max, byte_count, error);
  if (world->peace || *byte_count == 0) return result;
  std::uint64_t cost = static_cast<std::uint64_t>(static_cast<double>(*byte_count) * world->plan.read_ns);
  if (cost > 0) platform::kNullLink.poll(link, nullptr, 0, cost);
  Outside outside;
  double frame_ns = static_cast<double>(world->elapsed() - world->frame_begin_ns);
  bool takes_long = world->plan.has_scene &&
                    frame_ns > kStuckTimes * static_cast<double>(world->local_ns) + light_wait_max_ns(world->plan);
  world->stuck = world->stuck || ++world->reads > kStuckReads || takes_long;
  for (Place& place : world->places)
    if (place.hostile && !place.frozen && !world->stuck) step_hostile_server(place.hostile.get());
  return result;
}

platform::LinkBackend world_backend() {
  platform::LinkBackend backend = platform::kNullLink;
  backend.poll = poll_world;
  backend.read = read_world;
  return backend;
}
const platform::LinkBackend kWorldLink = world_backend();

}  // namespace

void note_faults() {
  int struck = platform::null_link_record(world->link).faults_struck;
  if (struck == world->faults_struck) return;
  world->faults_struck = struck;
  world->disturbed = true;
  world->disturbed_ns = world->elapsed();
}

void make_peace() {
  world->peace = true;
  for (platform::NullFault& fault : world->plan.faults) fault.connection = 1 << 30;
  for (HostileClient& neighbour : world->neighbours) close_hostile_client(world->link, &neighbour);
  for (std::uint32_t i = 0; i < world->plan.server_count; ++i) bring_back(i);
}

void let_pass(std::uint64_t ns) {
  for (std::uint64_t until = world->elapsed() + ns; world->elapsed() < until;)
    kWorldLink.poll(world->link, nullptr, 0, until - world->elapsed());
}

void open_fault_world(const FaultPlan& given, FaultWorld* w) {
  world = w;
  w->plan = given;
  FaultPlan& plan = w->plan;
  plan.line.faults = plan.faults;
  static std::vector<std::max_align_t> link_memory;
  platform::LinkOptions link_options;
  link_options.memory_bytes = null_link_need(kStreams, plan.line);
  link_memory.resize(link_options.memory_bytes / sizeof(std::max_align_t) + 1);
  link_options.memory = link_memory.data();
  link_options.stream_count_max = kStreams;
  platform::Error error;
  w->link = null_link_open(link_options, plan.line, &error);
  REQUIRE_MESSAGE(w->link != nullptr, error.text);
  platform::LinkAddress addresses[kSessionServersMax];
  for (std::uint32_t i = 0; i < plan.server_count; ++i) {
    std::string text = "127.0.0.1:" + std::to_string(4000 + i);
    REQUIRE(platform::kNullLink.resolve(text.c_str(), &addresses[i], &error));
    w->places[i].address = addresses[i];
    start(i);
  }
  for (int i = 0; i < plan.neighbour_count; ++i) {
    w->neighbours[i].is = plan.neighbours[i];
    w->neighbours[i].scene = builtin_hash(kFaultScene);
    w->neighbours[i].random.state = plan.seed + static_cast<std::uint64_t>(i);
  }
  w->link->backend = &kWorldLink;
  Settings settings = device_renderer(plan)->settings;
  if (plan.split != SplitKind::rows) settings.indirect = indirect_choice(Effect::instant_radiosity);
  REQUIRE(change_settings(device_renderer(plan), settings).ok);  // the session before has ended with any
  ClientOptions o;
  o.has_scene = plan.has_scene;
  o.coarse_after_ns = plan.coarse_first ? 1 : 0;
  o.light.split = plan.split, o.light.indirect = settings.indirect, o.light.wait_ns = plan.light_wait_ns;
  if (plan.split != SplitKind::rows) o.own_light_pixel_ns = kOwnLightPart * plan.device_ns;
  o.format = plan.format, o.dither = plan.dither, o.device_share = plan.device_share;
  o.check_count = plan.check_count;
  o.pace.ns_per_pixel = plan.device_ns;
  o.row_costs = w->plan.row_costs;
  o.connect_timeout_ns = kConnectNs, o.silence_timeout_ns = o.prepare_timeout_ns = kSilenceNs;
  o.retry_ns_min = kRetryMinNs, o.retry_ns_max = kRetryMaxNs;
  o.log = [](void*, const char* line) { world->log.push_back(line); };
  for (std::uint32_t row = 0; row < plan.height; ++row)
    w->local_ns += paced_ns(pace_of_rows(o.pace, o.row_costs, row, row + 1), plan.width, 0);
  w->client_memory.resize(client_need(settings, o.format, plan.server_count, o.light) + kArenaAlignment);
  Arena arena = make_arena("client", w->client_memory.data(), w->client_memory.size());
  Status status =
      make_client(o, settings, builtin_hash(kFaultScene), w->link, addresses, plan.server_count, &arena, &w->client);
  REQUIRE_MESSAGE(status.ok, status.message);
}

void close_fault_world(FaultWorld* w) {
  for (std::uint32_t i = 0; i < w->plan.server_count; ++i) kill(i);
  platform::kNullLink.close_all(w->link);
  world = nullptr;
}

}  // namespace pocketray
