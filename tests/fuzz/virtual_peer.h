// Shared by the fuzz targets of client and server: a link in simulated time, a small scene, and the input as a source
// of decisions.
#pragma once
#include <memory>
#include <vector>

#include "platform/null/net/null_link.h"
#include "remote/server/scene_store.h"
#include "support/generated_scene.h"
#include "wire/message.h"

namespace pocketray {

// Reads an input from the front; zeros follow its end.
struct FuzzInput {
  const std::uint8_t* at;
  std::size_t left;
  std::uint8_t byte() {
    if (left == 0) return 0;
    --left;
    return *at++;
  }
  std::vector<std::uint8_t> bytes(std::size_t count) {
    std::vector<std::uint8_t> taken(at, at + (count < left ? count : left));
    at += taken.size(), left -= taken.size();
    return taken;
  }
};

// Owns a link.
struct FuzzLink {
  std::vector<std::max_align_t> memory;
  platform::Link* link = nullptr;
  platform::LinkAddress address;
  explicit FuzzLink(const platform::NullLinkSettings& settings);
  ~FuzzLink();
  FuzzLink(const FuzzLink&) = delete;
  FuzzLink& operator=(const FuzzLink&) = delete;
};

// The built-in cube in a server's store.
const SceneStore& fuzz_store();
constexpr std::uint32_t kFuzzWidth = 16, kFuzzHeight = 12;
// A renderer for pictures of it of that size, for either side.
enum class FuzzSide { device, server };
Renderer* fuzz_renderer(FuzzSide side = FuzzSide::device);

// The message on the wire.
std::vector<std::uint8_t> wire_bytes(const Message& message);
// A message of any type and payload, with correct length and checksum.
std::vector<std::uint8_t> sealed_bytes(std::uint8_t type, const std::vector<std::uint8_t>& payload);
// Changes a byte of the payload and seals the message again.
void change_sealed(std::vector<std::uint8_t>* bytes, std::uint8_t offset, std::uint8_t difference);
// Writes as much as fits; false if the connection has ended.
bool write_some(platform::Link* link, int stream, std::vector<std::uint8_t>* bytes);

}  // namespace pocketray
