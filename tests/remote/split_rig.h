// A device and its servers in one simulated world, so that frames are reproducible.
#pragma once
#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "desktop/split_report/virtual_world.h"
#include "remote/client/frame.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

namespace pocketray {

inline platform::NullLinkSettings fine_clock() {
  platform::NullLinkSettings line;
  line.clock_step_ns = 50;
  return line;
}

struct SplitRigOptions {
  const char* scene = "cornell";
  std::uint32_t width = 64, height = 48;
  std::uint32_t server_count = 1;
  double device_ns = 1000;                              // per pixel
  double device_prepare_ns = 0, server_prepare_ns = 0;  // per frame
  std::vector<double> server_ns = {};                   // per pixel; missing entries repeat the last; empty: 100
  platform::NullLinkSettings line = fine_clock();
  CoherenceMode coherence = CoherenceMode::automatic;  // of device and servers
  bool compares = true;                                // compares every frame with the device's own
  CodeCost encode;                                     // of rows on servers
  ClientOptions client;
};

struct SplitRig {
  SplitRigOptions options;
  VirtualWorld world;
  std::vector<unsigned char> client_memory;
  std::unique_ptr<BuiltScene> built;
  std::unique_ptr<TestRenderer> device;
  std::unique_ptr<TestRenderer> whole;  // renders the device's frames whole, for comparison
  Client client;
  std::vector<std::string> log;

  explicit SplitRig(const SplitRigOptions& options);
  ~SplitRig();
  SplitRig(const SplitRig&) = delete;
  SplitRig& operator=(const SplitRig&) = delete;

  std::uint64_t now() { return world_now_ns(world); }
  void stop_server(std::uint32_t index);
  void start_server(std::uint32_t index);
  // Renders a frame by client and servers; compares it with the device's own if the options say so.
  const FrameShare& frame(double seconds);
  // Lets time pass without a frame.
  void idle(std::uint64_t ns);
  bool logged(const std::string& text) const;
  // The device's frame rendered whole and alone.
  std::vector<std::uint8_t> local_pixels(double seconds);
};

}  // namespace pocketray
