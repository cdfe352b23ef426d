#include "split_rig.h"

#include <algorithm>

#include "app/frame.h"
#include "app/server_state.h"
#include "base/seal.h"
#include "present/pack.h"
#include "scene/builtin_helpers.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kStepNs = 5'000;  // that time passes at once while somebody waits

SplitRig* current = nullptr;

// While the device waits, the servers work.
int poll_stepping(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  const platform::LinkBackend& net = platform::kNullLink;
  if (current->stepping) return net.poll(link, waits, wait_count, timeout_ns);
  current->stepping = true;
  std::uint64_t begin = net.now_ns(link);
  int ready = 0;
  for (;;) {
    std::uint64_t step = kStepNs;
    for (Server* server : current->servers)
      if (server) {
        step_server(server, 0);
        step = std::min(step, std::max<std::uint64_t>(200, work_due_ns(server)));
      }
    std::uint64_t passed = net.now_ns(link) - begin, left = passed < timeout_ns ? timeout_ns - passed : 0;
    ready = net.poll(link, waits, wait_count, std::min(left, step));
    if (ready > 0 || left <= step) break;
  }
  current->stepping = false;
  return ready;
}

platform::LinkBackend stepping_backend() {
  platform::LinkBackend backend = platform::kNullLink;
  backend.poll = poll_stepping;
  return backend;
}
const platform::LinkBackend kSteppingLink = stepping_backend();

}  // namespace

SplitRig::SplitRig(const SplitRigOptions& given) : options(given) {
  REQUIRE(current == nullptr);
  current = this;
  constexpr int kStreams = 64;
  platform::LinkOptions link_options;
  link_options.memory_bytes = null_link_need(kStreams, options.line);
  memory.resize(link_options.memory_bytes / sizeof(std::max_align_t) + 1);
  link_options.memory = memory.data();
  link_options.stream_count_max = kStreams;
  platform::Error error;
  link = null_link_open(link_options, options.line, &error);
  REQUIRE_MESSAGE(link != nullptr, error.text);
  servers.resize(options.server_count);
  addresses.resize(options.server_count);
  for (std::uint32_t i = 0; i < options.server_count; ++i) {
    REQUIRE(platform::kNullLink.resolve(":0", &addresses[i], &error));
    start_server(i);
  }
  link->backend = &kSteppingLink;  // as the client sees it

  built = build_builtin(options.scene);
  Settings settings;
  settings.width = options.width, settings.height = options.height;
  device = make_renderer(built->scene, settings);
  ClientOptions o = options.client;
  o.pace.ns_per_pixel = options.device_ns;
  o.log = [](void* rig, const char* line) { static_cast<SplitRig*>(rig)->log.push_back(line); };
  o.log_context = this;
  client_memory.resize(client_need(settings, o.format, options.server_count) + kArenaAlignment);
  Arena arena = make_arena("client", client_memory.data(), client_memory.size());
  Status status = make_client(o, settings, builtin_hash(options.scene), link, addresses.data(), options.server_count,
                              &arena, &client);
  REQUIRE_MESSAGE(status.ok, status.message);
}

SplitRig::~SplitRig() {
  close_client(&client);
  link->backend = &platform::kNullLink;
  for (Server* server : servers) close_server(server);
  platform::kNullLink.close_all(link);
  current = nullptr;
}

void SplitRig::start_server(std::uint32_t i) {
  const platform::LinkBackend* backend = link->backend;
  link->backend = &platform::kNullLink;
  ServerOptions o;
  o.client_memory_bytes = 16u << 20;
  o.client_count_max = 4;
  o.pace.ns_per_pixel = options.server_ns.empty()      ? 100
                        : i < options.server_ns.size() ? options.server_ns[i]
                                                       : options.server_ns.back();
  Status status = open_server(o, builtin_store(), link, addresses[i], &servers[i]);
  REQUIRE_MESSAGE(status.ok, status.message);
  platform::Error error;
  REQUIRE(platform::kNullLink.resolve(server_address(*servers[i]), &addresses[i], &error));
  link->backend = backend;
}

void SplitRig::stop_server(std::uint32_t i) {
  const platform::LinkBackend* backend = link->backend;
  link->backend = &platform::kNullLink;
  close_server(servers[i]);
  servers[i] = nullptr;
  link->backend = backend;
}

std::vector<std::uint8_t> SplitRig::local_pixels() {
  const Renderer& r = device->renderer;
  std::vector<std::uint8_t> pixels(client.pixels.count);
  int width = static_cast<int>(options.width), height = static_cast<int>(options.height);
  bool small = options.client.format == WireFormat::rgb565;
  pack_rows(r.image.data, width, height, 0, height, r.exposure, small ? kRgb565 : kRgb888, Rotation::none,
            options.client.dither, pixels.data(), width * (small ? 2 : 3));
  return pixels;
}

const FrameShare& SplitRig::frame(double seconds) {
  REQUIRE(render_shared_frame(&device->renderer, &client, seconds).ok);
  std::vector<std::uint8_t> merged(client.pixels.begin(), client.pixels.end());
  REQUIRE(render_frame(&device->renderer, seconds).ok);
  CHECK(merged == local_pixels());
  return client.share;
}

void SplitRig::idle(std::uint64_t ns) {
  for (std::uint64_t end = now() + ns; now() < end;) advance_client(&client, end - now());
}

bool SplitRig::logged(const std::string& text) const {
  return std::any_of(log.begin(), log.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

}  // namespace pocketray
