// A device and a server that misbehaves as a test wants, in virtual time.
#pragma once
#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fake_server.h"
#include "remote/client/frame.h"
#include "scene/builtin_helpers.h"
#include "split_rig.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

namespace pocketray {

constexpr std::uint32_t kWidth = 32, kHeight = 64;
constexpr double kDeviceNs = 20'000, kLocalNs = kDeviceNs * kWidth * kHeight;  // 41 ms per frame
constexpr std::uint32_t kFloodMessages = 20'000;  // ends a flood, so that a device caught in it fails the test

// A device and a server that is well-behaved unless a test overrides it.
struct HostileRig {
  RowSource rows{kWidth, kHeight, WireFormat::rgb565};
  FrameRequest request;                                                  // the last
  std::vector<FrameRequest> all;                                         // received
  std::function<std::vector<Message>(HostileRig*, const Message&)> act;  // overrides its answers; empty: well-behaved
  FakeServer fake{[this](const Message& message) { return act ? act(this, message) : answer(message); }, fine_clock()};
  std::unique_ptr<BuiltScene> built = build_builtin("cube");
  std::unique_ptr<TestRenderer> device;
  std::vector<std::uint8_t> memory;
  std::vector<std::string> log;
  std::vector<std::uint8_t> payload = std::vector<std::uint8_t>(kPingBytesMax);
  std::uint32_t flood_count = 0;
  Client client;

  explicit HostileRig(bool has_scene = true, const LightOptions& light = LightOptions()) {
    Settings settings;
    settings.width = kWidth, settings.height = kHeight;
    settings.indirect = light.indirect;
    device = make_renderer(built->scene, settings);
    ClientOptions o;
    o.format = WireFormat::rgb565;
    o.pace.ns_per_pixel = kDeviceNs;
    o.check_count = 0;  // its rows show no scene
    o.log = [](void* rig, const char* line) { static_cast<HostileRig*>(rig)->log.push_back(line); };
    o.log_context = this;
    o.has_scene = has_scene, o.light = light;
    memory.resize(client_need(settings, o.format, 1, light) + kArenaAlignment);
    Arena arena = make_arena("client", memory.data(), memory.size());
    REQUIRE(make_client(o, settings, builtin_hash("cube"), fake.link, &fake.address, 1, &arena, &client).ok);
  }
  ~HostileRig() { close_client(&client); }

  Message entry() {
    Message message;
    message.type = MessageType::scene_entry;
    message.scene_entry.hash = builtin_hash("cube");
    message.scene_entry.byte_count = 1000;
    return message;
  }
  Message pong(const Ping& ping) {
    Message message;
    message.type = MessageType::pong;
    message.pong = {ping.id, 100'000, kPriceUnit, {payload.data(), ping.reply_bytes}};
    return message;
  }
  // The answer of a well-behaved server.
  std::vector<Message> answer(const Message& message) {
    if (message.type == MessageType::hello) {
      rows.restart();
      return {hello_of_server()};
    }
    if (message.type == MessageType::scene_query) return {entry()};
    if (message.type == MessageType::ping) return {pong(message.ping)};
    if (!note_request(message)) return {};
    return rows.rows(request);
  }
  bool note_request(const Message& message) {
    if (message.type == MessageType::frame_request)
      request = message.frame_request;
    else if (message.type == MessageType::frame_change)
      take_change(message.frame_request, &request);
    else
      return false;
    all.push_back(request);
    return true;
  }

  bool is_ready() const { return client.servers[0].overture.phase == ServerPhase::ready; }
  // Renders a frame; returns its time relative to the device's alone.
  double frame() {
    std::uint64_t begin = fake.now();
    REQUIRE(render_frame(&device->renderer, &client, 0).ok);
    return static_cast<double>(fake.now() - begin) / kLocalNs;
  }
  void frames_until_ready() {
    for (int i = 0; i < 20 && !is_ready(); ++i) frame();
    REQUIRE(is_ready());
    frame();
  }
  void flood_with(const std::function<Message()>& make) {
    fake.flood = [this, make]() -> std::vector<std::uint8_t> {
      std::vector<std::uint8_t> bytes;
      for (int i = 0; i < 100 && flood_count < kFloodMessages; ++i, ++flood_count) {
        std::vector<std::uint8_t> one = bytes_of(make());
        bytes.insert(bytes.end(), one.begin(), one.end());
      }
      return bytes;
    };
  }
};

}  // namespace pocketray
