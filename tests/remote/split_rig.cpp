#include "split_rig.h"

#include <algorithm>

#include "engine/frame.h"
#include "present/pack.h"
#include "scene/builtin_helpers.h"

namespace pocketray {

SplitRig::SplitRig(const SplitRigOptions& given) : options(given) {
  Status status = open_world(options.line, builtin_store(), options.server_count, &world);
  REQUIRE_MESSAGE(status.ok, status.message);
  for (std::uint32_t i = 0; i < options.server_count; ++i) start_server(i);

  built = build_builtin(options.scene);
  Settings settings;
  settings.width = options.width, settings.height = options.height;
  settings.indirect = options.client.light.indirect;
  whole = make_renderer(built->scene, settings);
  settings.coherence = options.coherence;
  device = make_renderer(built->scene, settings);
  ClientOptions o = options.client;
  o.pace.ns_per_pixel = options.device_ns, o.pace.prepare_ns = options.device_prepare_ns;
  o.log = [](void* rig, const char* line) { static_cast<SplitRig*>(rig)->log.push_back(line); };
  o.log_context = this;
  client_memory.resize(client_need(settings, o.format, options.server_count, o.light) + kArenaAlignment);
  Arena arena = make_arena("client", client_memory.data(), client_memory.size());
  status = make_client(o, settings, builtin_hash(options.scene), world.link, world.addresses.data(),
                       options.server_count, &arena, &client);
  REQUIRE_MESSAGE(status.ok, status.message);
}

SplitRig::~SplitRig() { close_client(&client); }

void SplitRig::start_server(std::uint32_t i) {
  ServerOptions o;
  o.client_memory_bytes = 16u << 20;
  o.client_count_max = 4;
  o.coherence = options.coherence;
  o.encode = options.encode;
  o.pace.prepare_ns = options.server_prepare_ns;
  o.pace.ns_per_pixel = options.server_ns.empty()      ? 100
                        : i < options.server_ns.size() ? options.server_ns[i]
                                                       : options.server_ns.back();
  Status status = pocketray::start_server(&world, i, o);
  REQUIRE_MESSAGE(status.ok, status.message);
}

void SplitRig::stop_server(std::uint32_t i) { pocketray::stop_server(&world, i); }

std::vector<std::uint8_t> SplitRig::local_pixels(double seconds) {
  Renderer& renderer = whole->renderer;
  renderer.view.camera = device->renderer.view.camera,
  renderer.view.camera_overridden = device->renderer.view.camera_overridden;
  renderer.view.camera_index = device->renderer.view.camera_index,
  renderer.view.exposure = device->renderer.view.exposure;
  REQUIRE(render_frame(&renderer, seconds).ok);
  std::vector<std::uint8_t> pixels(client.picture.pixels.count);
  int width = static_cast<int>(options.width), height = static_cast<int>(options.height);
  bool small = options.client.format == WireFormat::rgb565;
  pack_rows(renderer.image.data, width, height, 0, height, display_of(renderer), small ? kRgb565 : kRgb888,
            Rotation::none, options.client.dither, pixels.data(), width * (small ? 2 : 3));
  return pixels;
}

const FrameShare& SplitRig::frame(double seconds) {
  REQUIRE(render_frame(&device->renderer, &client, seconds).ok);
  if (!options.compares) return client.share;
  std::vector<std::uint8_t> merged(client.picture.pixels.begin(), client.picture.pixels.end());
  CHECK(merged == local_pixels(seconds));
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
