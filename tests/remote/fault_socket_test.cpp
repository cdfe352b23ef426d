// Failing servers and lines over real sockets.
#include <doctest/doctest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "engine/frame.h"
#include "platform/net/tcp.h"
#include "present/pack.h"
#include "remote/client/frame.h"
#include "remote/server/session.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/faulty_proxy.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 16, kHeight = 24;
constexpr double kDeviceNs = 12e6 / (kWidth * kHeight);  // a frame alone takes 12 ms
constexpr double kSlackNs = 80e6;                        // delay of a frame by other work of the machine
constexpr int kAttempts = 6;                             // to find the machine idle enough
constexpr std::uint64_t kSilenceNs = 150 * kMs;  // short, since tests wait for it; a busy machine may cause it too
constexpr std::uint64_t kCalmSilenceNs = 20'000 * kMs;  // if no loss may be reported
constexpr int kMessages = 12;  // messages to the device: the overture's, and chunks of some frames

// Frames are also timed only then, when the machine is idle. Simulated sessions are always timed.
bool is_thorough() { return std::getenv("POCKETRAY_FAULT_SESSIONS") != nullptr; }

std::atomic<std::int64_t> clock_offset_ns{0};
std::uint64_t wall_ns() {
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
}
std::uint64_t shifted_ns() { return wall_ns() + static_cast<std::uint64_t>(clock_offset_ns.load()); }

struct TcpLink {
  std::vector<std::max_align_t> memory;
  platform::Link* link = nullptr;
  explicit TcpLink(int stream_count, std::uint64_t (*now_ns)() = wall_ns) {
    platform::LinkOptions o;
    o.memory_bytes = platform::kTcpLink.need(stream_count);
    memory.resize(o.memory_bytes / sizeof(std::max_align_t) + 1);
    o.memory = memory.data(), o.stream_count_max = stream_count, o.now_ns = now_ns;
    platform::Error error;
    link = platform::kTcpLink.open(o, &error);
    REQUIRE_MESSAGE(link != nullptr, error.text);
  }
  ~TcpLink() { platform::kTcpLink.close_all(link); }
};

platform::LinkAddress address_of(int port) {
  platform::LinkAddress address;
  platform::Error error;
  REQUIRE(platform::kTcpLink.resolve(("127.0.0.1:" + std::to_string(port)).c_str(), &address, &error));
  return address;
}

// A server process: reports its port and serves until killed or without clients.
void run_server(int port_to) {
  TcpLink link(40);
  ServerOptions o;
  o.client_memory_bytes = kSessionBytesMin;
  o.pace.ns_per_pixel = kDeviceNs / 20;
  o.idle_timeout_ns = 2'000 * kMs;
  Server* server = nullptr;
  if (!open_server(o, builtin_store(), link.link, address_of(0), &server).ok) return;
  int port = std::atoi(std::strrchr(server_address(*server), ':') + 1);
  if (write(port_to, &port, sizeof port) != sizeof port) return;
  close(port_to);
  for (pid_t parent = getppid(); getppid() == parent;) step_server(server, 100 * kMs);
}

// A device that uses one server.
struct Device {
  std::unique_ptr<BuiltScene> built = build_builtin("cube");
  std::unique_ptr<TestRenderer> renderer;
  TcpLink link{8, shifted_ns};
  std::vector<std::uint8_t> memory;
  std::vector<std::string> log;
  Client client;
  int frame_count = 0;
  double worst_ns = 0;  // since last reset to 0
  std::string failure;

  explicit Device(int port, std::uint64_t silence_ns = kSilenceNs) {
    Settings settings;
    settings.width = kWidth, settings.height = kHeight, settings.memory_bytes = 8u << 20;
    renderer = make_renderer(built->scene, settings);
    ClientOptions o;
    o.pace.ns_per_pixel = kDeviceNs;
    o.connect_timeout_ns = silence_ns, o.silence_timeout_ns = o.prepare_timeout_ns = silence_ns;
    o.retry_ns_min = 10 * kMs, o.retry_ns_max = 40 * kMs;
    o.log = [](void* device, const char* line) { static_cast<Device*>(device)->log.push_back(line); };
    o.log_context = this;
    memory.resize(client_need(settings, o.format, 1) + kArenaAlignment);
    Arena arena = make_arena("client", memory.data(), memory.size());
    platform::LinkAddress address = address_of(port);
    REQUIRE(make_client(o, settings, builtin_hash("cube"), link.link, &address, 1, &arena, &client).ok);
  }
  ~Device() { close_client(&client); }

  bool is_ready() const { return client.servers[0].overture.phase == ServerPhase::ready; }

  // A frame, compared with the device's own.
  void frame() {
    static std::map<int, std::vector<std::uint8_t>> pictures;
    int second = frame_count++ % 4;
    Renderer* own = &renderer->renderer;
    std::vector<std::uint8_t>& expected = pictures[second];
    if (expected.empty()) {
      REQUIRE(render_frame(own, 0.3 * second).ok);
      expected.resize(client.picture.pixels.count);
      pack_rows(own->image.data, kWidth, kHeight, 0, kHeight, display_of(*own), kRgb888, Rotation::none, false,
                expected.data(), kWidth * 3);
    }
    std::uint64_t begin = wall_ns();
    bool complete = false;
    REQUIRE(render_frame(own, &client, 0.3 * second, nullptr, &complete).ok);
    worst_ns = std::max(worst_ns, static_cast<double>(wall_ns() - begin));
    if (!complete) failure = "a frame is not complete";
    if (!std::equal(expected.begin(), expected.end(), client.picture.pixels.begin()))
      failure = "a frame is not the device's own";
  }
  void pause(std::uint64_t ns) {
    for (std::uint64_t until = wall_ns() + ns, now = wall_ns(); now < until; now = wall_ns())
      advance_client(&client, until - now);
  }
  // Renders frames until the condition holds, for at most ten seconds.
  template <class Condition>
  bool frames_until(Condition condition) {
    for (std::uint64_t begin = wall_ns(); !condition();) {
      if (wall_ns() - begin > 10'000 * kMs) return false;
      frame();
      pause(2 * kMs);
    }
    return true;
  }
  int lines_with(const char* text) const {
    return static_cast<int>(
        std::count_if(log.begin(), log.end(), [&](const std::string& line) { return line.find(text) != line.npos; }));
  }
  std::string first_line() const { return log.empty() ? "" : log.front(); }
  bool is_late() const { return is_thorough() && worst_ns > 2 * kDeviceNs * kWidth * kHeight + kSlackNs; }
};

ServerProcess& the_server() {
  static ServerProcess server;
  return server;
}
void start_server() {
  builtin_store();
  the_server().start(run_server);
  REQUIRE(the_server().port != 0);
}

// Runs one fault, from the first byte until the server is in use again. Empty: success; "late": maybe.
std::string run_fault(const ProxyPlan& plan) {
  if (the_server().pid <= 0) start_server();
  FaultyProxy proxy(plan, &the_server());
  Device device(proxy.port);
  bool harmless = plan.fault == ProxyFault::none;
  if (!device.frames_until([&] { return proxy.struck.load() || harmless; })) return "the fault did not strike";
  if (!device.frames_until([&] { return !device.log.empty() || harmless; })) return "the loss is not reported";
  if (plan.fault == ProxyFault::kill || plan.fault == ProxyFault::stop) start_server();
  if (!device.frames_until([&] { return device.is_ready(); })) return "the server is not in use again";
  for (int i = 0; i < 2; ++i) device.frame();
  if (!device.failure.empty()) return device.failure;
  if (!harmless && (device.lines_with("continuing without it") != 1 || device.lines_with("in use again") != 1))
    return "not one line for the loss and one for the return: " + device.first_line();
  if (harmless && !device.log.empty()) return "it says " + device.first_line();
  return device.is_late() ? "late" : "";
}

void check_fault(const ProxyPlan& plan) {
  std::string failure;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // A busy machine may delay a frame or silence the server once more, but never makes pixels wrong.
    if (failure = run_fault(plan); failure.empty() || failure.find("a frame") == 0) break;
    the_server().kill();
  }
  if (failure.empty()) return;
  std::string where = proxy_fault_name(plan.fault) + std::string(plan.middle ? " in the middle of" : " at");
  FAIL_CHECK(where << " message " << plan.message << ": " << failure);
}

}  // namespace

// Goal: if a server is killed or stopped, or a line breaks, falls silent, trickles or corrupts bytes, at or within any
// message to the device, frames stay complete, correct and in time, the loss is logged in one line, and the server
// returns. Method: a proxy in front of a server process.
TEST_CASE("faults_over_sockets_cost_no_pixel") {
  for (ProxyFault fault : {ProxyFault::kill, ProxyFault::stop, ProxyFault::truncate, ProxyFault::reset,
                           ProxyFault::flip, ProxyFault::silence, ProxyFault::trickle})
    for (int message = 0; message < effort(kMessages); ++message)
      for (bool middle : {false, true}) {
        // All of them in `make faults`.
        if (!is_thorough() && (message + middle + static_cast<int>(fault)) % 3 != 0) continue;
        ProxyPlan plan;
        plan.fault = fault, plan.message = message, plan.middle = middle;
        check_fault(plan);
      }
}

// Goal: repeated, reordered or outdated rows do not get into the picture. Method: a proxy that repeats and swaps
// messages from the first chunk on.
TEST_CASE("faults_over_sockets_replayed_rows_do_not_count") {
  for (ProxyFault fault : {ProxyFault::duplicate, ProxyFault::swap, ProxyFault::replay})
    for (int message = 6; message < 6 + effort(6); ++message) {
      ProxyPlan plan;
      plan.fault = fault, plan.message = message;
      check_fault(plan);
    }
}

// Goal: a server of another version, without the scene, or shut down is logged in a specific line, and frames go on.
// Method: replace one message of the overture.
TEST_CASE("faults_over_sockets_tell_what_is_wrong") {
  struct Case {
    Message message;
    int index;
    const char* text;
  };
  std::vector<Case> cases(4);
  cases[0].message.type = MessageType::hello;
  cases[0].message.hello.version = kWireVersion + 1;
  cases[0].text = "version";
  cases[1].message.type = MessageType::scene_entry;
  cases[1].index = 1, cases[1].text = "does not have this scene";
  cases[2].message.type = MessageType::error;
  cases[2].message.error.code = WireError::busy;
  cases[2].index = 2, cases[2].text = "it is full";
  cases[3].message.type = MessageType::frame_request;
  cases[3].message.frame_request = frame_request("cube", 1);
  cases[3].index = 3, cases[3].text = "unrequested";
  for (const Case& c : cases) {
    if (the_server().pid <= 0) start_server();
    ProxyPlan plan;
    plan.fault = ProxyFault::replace, plan.message = c.index, plan.bytes = bytes_of(c.message);
    check_fault(plan);
    FaultyProxy proxy(plan, &the_server());
    Device device(proxy.port);
    CHECK(device.frames_until([&] { return !device.log.empty(); }));
    CHECK_MESSAGE(device.lines_with(c.text) == 1, device.first_line());
  }
}

// Goal: a missing or silent server costs no frame. Method: a port without a listener, and one without accept(); then
// the server appears.
TEST_CASE("faults_over_sockets_nobody_answers") {
  for (bool listens : {false, true}) {
    int port = 0, listener = listen_locally(&port);
    if (!listens) close(listener);
    std::string failure;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      Device device(port);
      CHECK(device.frames_until([&] { return !device.log.empty(); }));
      for (int i = 0; i < 8; ++i) device.frame();
      CHECK(device.failure == "");
      CHECK(device.log.size() == 1);
      CHECK(device.lines_with(listens ? "does not answer" : "nothing is listening there") == 1);
      failure = device.is_late() ? "late" : "";
      if (failure.empty()) break;
    }
    CHECK(failure == "");
    if (listens) close(listener);
  }
}

// Goal: a clock that is set back does not hold up frames. Method: by ten seconds, during the overture and later; a
// frame waiting for the clock would take that long.
TEST_CASE("faults_over_sockets_clock_is_set_back") {
  if (the_server().pid <= 0) start_server();
  FaultyProxy proxy(ProxyPlan(), &the_server());
  Device device(proxy.port, kCalmSilenceNs);
  for (int i = 0; i < 20; ++i) {
    std::uint64_t before = client_now_ns(device.client);
    if (i % 3 == 1) clock_offset_ns -= 10'000'000'000;
    CHECK(client_now_ns(device.client) >= before);
    device.frame();
    device.pause(2 * kMs);
  }
  CHECK(device.frames_until([&] { return device.is_ready(); }));
  CHECK(device.failure == "");
  CHECK_MESSAGE(device.log.empty(), device.first_line());
  CHECK(device.worst_ns < 5e9);
}

// Goal: ten thousand successive connections leak neither descriptors nor places. Method: some of them here, all in
// `make faults`; with a goodbye or without.
TEST_CASE("faults_over_sockets_reconnects_leave_nothing_behind") {
  if (the_server().pid <= 0) start_server();
  auto descriptor = [] {
    int file = dup(0);
    close(file);
    return file;
  };
  Device device(the_server().port, kCalmSilenceNs);
  CHECK(device.frames_until([&] { return device.is_ready(); }));
  int before = descriptor();
  for (int i = 0; i < (is_thorough() ? 10'000 : effort(300)); ++i) {
    RemoteServer* s = &device.client.servers[0];
    close_message_stream(&s->messages);  // like a radio switched off
    s->overture.phase = ServerPhase::waiting;
    s->overture.retry_ns = 0;
    s->overture.timer = platform::link_timer(client_now_ns(device.client), 0);
    for (std::uint64_t begin = wall_ns();
         s->overture.phase < ServerPhase::measuring && wall_ns() - begin < 10'000 * kMs;)
      advance_client(&device.client, kMs);
    if (s->overture.phase < ServerPhase::measuring) FAIL("connection " << i << " does not come about");
  }
  CHECK(descriptor() == before);
  CHECK(device.frames_until([&] { return device.is_ready(); }));
  CHECK(device.failure == "");
  CHECK_MESSAGE(device.log.empty(), device.first_line());
}
