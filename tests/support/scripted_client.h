// A render server over a simulated link or sockets, and clients controlled by a test, message by message.
#pragma once
#include <doctest/doctest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "platform/link.h"
#include "platform/null/net/null_link.h"
#include "remote/server/server.h"
#include "wire/codec.h"

namespace pocketray {

constexpr std::uint64_t kMs = 1'000'000;

// The built-in scenes, read once for all tests.
const SceneStore& builtin_store();
ContentHash builtin_hash(const std::string& name);

// Link, server and its log.
struct ServerRig {
  std::vector<std::max_align_t> memory;
  platform::Link* link = nullptr;
  const platform::LinkBackend* net = nullptr;
  platform::LinkAddress address;
  Server* server = nullptr;
  std::vector<std::string> log;

  explicit ServerRig(const ServerOptions& options = ServerOptions(),
                     const platform::NullLinkSettings& settings = platform::NullLinkSettings(),
                     const platform::LinkBackend& backend = platform::kNullLink,
                     const SceneStore& store = builtin_store());
  ~ServerRig();
  ServerRig(const ServerRig&) = delete;
  ServerRig& operator=(const ServerRig&) = delete;

  std::uint64_t now() { return net->now_ns(link); }
  void step(std::uint64_t timeout_ns = kMs);  // under the seal
  void close();                               // the server
  // Steps the server and calls `more` until `done`; fails the test after `timeout_ns`.
  void run_until(const std::function<bool()>& done, std::uint64_t timeout_ns = 20'000 * kMs);
  bool logged(const std::string& text) const;
};

// A message as received, with its bytes.
struct Received {
  Message message;
  std::vector<std::uint8_t> bytes;
};

struct ScriptedClient {
  ServerRig* rig;
  int stream = -1;
  bool reads = true;
  bool closed = false;  // by the server
  std::vector<std::uint8_t> input;
  std::vector<std::unique_ptr<Received>> received;  // except rows
  std::uint64_t received_bytes = 0;

  // The picture of the requested frame.
  std::vector<std::uint8_t> block;
  Arena arena;
  RowDecoder* decoder = nullptr;
  std::vector<RowChunk> chunks;  // of that frame, without their bytes
  std::uint32_t frame = 0, rows_come = 0, chunk_count = 0;
  std::uint16_t price = 0;  // as the server said last in a chunk

  // Connects, and says hello on request.
  explicit ScriptedClient(ServerRig* rig, bool says_hello = true);
  ~ScriptedClient();
  ScriptedClient(const ScriptedClient&) = delete;
  ScriptedClient& operator=(const ScriptedClient&) = delete;

  void send_bytes(const std::vector<std::uint8_t>& bytes);
  void send(const Message& message);
  void send_hello();
  void request(const FrameRequest& request, MessageType type = MessageType::frame_request);
  // Processes received bytes.
  void poll();
  // Runs the server until a message of the type has arrived, and removes it.
  std::unique_ptr<Received> wait_for(MessageType type, std::uint64_t timeout_ns = 20'000 * kMs);
  bool has(MessageType type) const;
  bool has_error(WireError code) const;
  // Runs the server until all rows of the frame have arrived.
  void wait_for_rows(std::uint32_t row_count);
  std::vector<std::uint8_t> picture() const;
};

Message hello_message();
// For a whole frame of a built-in scene.
FrameRequest frame_request(const std::string& scene, std::uint32_t frame, std::uint32_t width = 64,
                           std::uint32_t height = 48);
// The same frame from render_frame() and pack_rows().
std::vector<std::uint8_t> rendered_here(const FrameRequest& request, const SceneStore& store = builtin_store());
// The coarse picture of it: the top left pixel of each square.
std::vector<std::uint8_t> squares_of(const std::vector<std::uint8_t>& picture, const FrameRequest& request);
std::vector<std::uint8_t> bytes_of(const Message& message);

}  // namespace pocketray
