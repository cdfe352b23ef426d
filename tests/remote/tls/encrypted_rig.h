// A device and a render server over one simulated link, each with a key or without.
#pragma once
#include <doctest/doctest.h>

#include <memory>
#include <string>
#include <vector>

#include "platform/net/tls/tls_link.h"
#include "platform/null/net/null_link.h"
#include "remote/client/frame.h"
#include "scene/builtin_helpers.h"
#include "support/generated_scene.h"
#include "support/scripted_client.h"

namespace pocketray {

struct EncryptedRig;

// The device's link, in whose poll the server works.
struct EncryptedRigBackend : platform::LinkBackend {
  EncryptedRig* rig = nullptr;
};

struct EncryptedRig {
  static constexpr int kPlain = -1;  // in place of a key

  std::vector<std::max_align_t> memory[3];
  std::vector<unsigned char> client_memory;
  platform::Link *below = nullptr, *server_link = nullptr, *device_link = nullptr;
  EncryptedRigBackend backend;
  platform::LinkBackend device_net = {};  // its functions without the server's work
  bool stepping = false;
  platform::LinkAddress address;
  Server* server = nullptr;
  ServerOptions server_options;
  std::unique_ptr<BuiltScene> built;
  std::unique_ptr<TestRenderer> device, whole;  // whole: renders the device's frames alone, for comparison
  Client client;
  std::vector<std::string> log, server_log;

  // Frames of 64×48 pixels of seesaw.
  EncryptedRig(int server_key, int device_key, double device_ns = 2000);
  ~EncryptedRig();
  EncryptedRig(const EncryptedRig&) = delete;
  EncryptedRig& operator=(const EncryptedRig&) = delete;

  void start_server();
  void stop_server();
  // Renders a frame and compares it with the device's own.
  const FrameShare& frame(double seconds);
  bool in_use() const { return client.servers[0].overture.phase == ServerPhase::ready; }
  void frames_until_in_use();
  static bool has(const std::vector<std::string>& log, const std::string& text);
};

}  // namespace pocketray
