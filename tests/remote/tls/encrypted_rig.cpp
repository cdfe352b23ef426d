#include "remote/tls/encrypted_rig.h"

#include <algorithm>

#include "engine/frame.h"
#include "present/pack.h"
#include "support/test_entropy.h"

namespace pocketray {
namespace {

constexpr int kStreams = 40;
constexpr std::uint64_t kStepNs = 5'000;

int poll_stepping(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  EncryptedRig* rig = static_cast<const EncryptedRigBackend*>(link->backend)->rig;
  if (rig->stepping) return rig->device_net.poll(link, waits, wait_count, timeout_ns);
  rig->stepping = true;
  std::uint64_t begin = rig->device_net.now_ns(link);
  int ready = 0;
  for (;;) {
    std::uint64_t step = std::max(kStepNs, (rig->device_net.now_ns(link) - begin) / 64);
    if (rig->server) step_server(rig->server, 0);
    std::uint64_t passed = rig->device_net.now_ns(link) - begin, left = passed < timeout_ns ? timeout_ns - passed : 0;
    ready = rig->device_net.poll(link, waits, wait_count, std::min(left, step));
    if (ready > 0 || left <= step) break;
  }
  rig->stepping = false;
  return ready;
}

platform::Link* encrypt(platform::Link* below, int key, std::vector<std::max_align_t>* memory) {
  if (key == EncryptedRig::kPlain) return below;
  platform::LinkOptions options;
  options.memory_bytes = platform::tls_link_need(kStreams);
  memory->resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = memory->data();
  options.stream_count_max = kStreams;
  platform::TlsLinkSettings settings;
  settings.key.bytes[0] = static_cast<unsigned char>(key);
  settings.random = test_random_bytes;
  platform::Error error;
  platform::Link* link = platform::tls_link_open(below, options, settings, &error);
  REQUIRE_MESSAGE(link != nullptr, error.text);
  return link;
}

}  // namespace

EncryptedRig::EncryptedRig(int server_key, int device_key, double device_ns) {
  seed_test_entropy(5);
  platform::NullLinkSettings settings;
  settings.clock_step_ns = 50;
  platform::LinkOptions options;
  options.stream_count_max = 3 * kStreams;
  options.memory_bytes = platform::null_link_need(options.stream_count_max, settings);
  memory[0].resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = memory[0].data();
  platform::Error error;
  below = platform::null_link_open(options, settings, &error);
  REQUIRE_MESSAGE(below != nullptr, error.text);
  server_link = encrypt(below, server_key, &memory[1]);
  device_link = encrypt(below, device_key, &memory[2]);
  device_net = *device_link->backend;
  static_cast<platform::LinkBackend&>(backend) = device_net;
  backend.poll = poll_stepping;
  backend.rig = this;
  device_link->backend = &backend;
  REQUIRE(platform::kNullLink.resolve(":0", &address, &error));
  server_options.client_memory_bytes = 16u << 20;
  server_options.client_count_max = 4;
  server_options.pace.ns_per_pixel = 100;
  server_options.log = [](void* rig, const char* line) { static_cast<EncryptedRig*>(rig)->server_log.push_back(line); };
  server_options.log_context = this;
  start_server();

  built = build_builtin("seesaw");
  Settings picture;
  picture.width = 64, picture.height = 48;
  whole = make_renderer(built->scene, picture);
  device = make_renderer(built->scene, picture);
  ClientOptions o;
  o.pace.ns_per_pixel = device_ns;
  o.log = [](void* rig, const char* line) { static_cast<EncryptedRig*>(rig)->log.push_back(line); };
  o.log_context = this;
  client_memory.resize(client_need(picture, o.format, 1) + kArenaAlignment);
  Arena arena = make_arena("client", client_memory.data(), client_memory.size());
  Status status = make_client(o, picture, builtin_hash("seesaw"), device_link, &address, 1, &arena, &client);
  REQUIRE_MESSAGE(status.ok, status.message);
}

EncryptedRig::~EncryptedRig() {
  close_client(&client);
  stop_server();
  if (device_link != below) device_net.close_all(device_link);
  if (server_link != below) server_link->backend->close_all(server_link);
  platform::kNullLink.close_all(below);
}

void EncryptedRig::start_server() {
  Status status = open_server(server_options, builtin_store(), server_link, address, &server);
  REQUIRE_MESSAGE(status.ok, status.message);
  platform::Error error;
  REQUIRE(platform::kNullLink.resolve(server_address(*server), &address, &error));
}

void EncryptedRig::stop_server() {
  stepping = true;
  close_server(server);
  server = nullptr;
  stepping = false;
}

const FrameShare& EncryptedRig::frame(double seconds) {
  REQUIRE(render_frame(&device->renderer, &client, seconds).ok);
  Renderer& renderer = whole->renderer;
  REQUIRE(render_frame(&renderer, seconds).ok);
  std::vector<std::uint8_t> merged(client.picture.pixels.begin(), client.picture.pixels.end()), own(merged.size());
  pack_rows(renderer.image.data, 64, 48, 0, 48, display_of(renderer), kRgb888, Rotation::none, false, own.data(),
            64 * 3);
  CHECK(merged == own);
  return client.share;
}

void EncryptedRig::frames_until_in_use() {
  for (int i = 0; i < 40 && !in_use(); ++i) frame(0.1 * i);
  REQUIRE(in_use());
}

bool EncryptedRig::has(const std::vector<std::string>& log, const std::string& text) {
  return std::any_of(log.begin(), log.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

}  // namespace pocketray
