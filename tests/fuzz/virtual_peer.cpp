#include "fuzz/virtual_peer.h"

#include <zlib.h>

#include <algorithm>

#include "base/check.h"
#include "scene/builtin_helpers.h"

namespace pocketray {
namespace {

constexpr int kStreams = 12;

}  // namespace

FuzzLink::FuzzLink(const platform::NullLinkSettings& settings) {
  platform::LinkOptions options;
  options.memory_bytes = null_link_need(kStreams, settings);
  memory.resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = memory.data();
  options.stream_count_max = kStreams;
  platform::Error error;
  link = null_link_open(options, settings, &error);
  CHECK(link != nullptr);
  CHECK(platform::kNullLink.resolve("127.0.0.1:4000", &address, &error));
}

FuzzLink::~FuzzLink() { platform::kNullLink.close_all(link); }

const SceneStore& fuzz_store() {
  static SceneStore store;
  if (store.scenes.empty()) CHECK(store_scene("cube", "cube", false, std::uint64_t(1) << 30, &store).ok);
  return store;
}

Renderer* fuzz_renderer(FuzzSide side) {
  static std::unique_ptr<BuiltScene> built;
  static std::unique_ptr<TestRenderer> tests[2];
  std::unique_ptr<TestRenderer>& test = tests[static_cast<int>(side)];
  if (!built) built = build_builtin("cube");
  if (!test) {
    Settings settings;
    settings.width = kFuzzWidth, settings.height = kFuzzHeight;
    settings.memory_bytes = 8u << 20;
    settings.indirect = indirect_choice(Effect::instant_radiosity);  // planned, so that clients may choose it
    test = make_renderer(built->scene, settings);
  }
  return &test->renderer;
}

std::vector<std::uint8_t> wire_bytes(const Message& message) {
  std::vector<std::uint8_t> bytes(message_bytes(message));
  encode_message(message, bytes.data());
  return bytes;
}

namespace {

void seal(std::vector<std::uint8_t>* bytes) {
  uLong sum =
      crc32(crc32(0, bytes->data(), 4), bytes->data() + kHeaderBytes, static_cast<uInt>(bytes->size() - kHeaderBytes));
  for (std::uint32_t i = 0; i < 4; ++i) (*bytes)[4 + i] = static_cast<std::uint8_t>(sum >> 8 * i);
}

}  // namespace

std::vector<std::uint8_t> sealed_bytes(std::uint8_t type, const std::vector<std::uint8_t>& payload) {
  std::vector<std::uint8_t> bytes(kHeaderBytes + payload.size());
  bytes[0] = type;
  for (std::uint32_t i = 0; i < 3; ++i) bytes[1 + i] = static_cast<std::uint8_t>(payload.size() >> 8 * i);
  std::copy(payload.begin(), payload.end(), bytes.begin() + kHeaderBytes);
  seal(&bytes);
  return bytes;
}

void change_sealed(std::vector<std::uint8_t>* bytes, std::uint8_t offset, std::uint8_t difference) {
  if (bytes->size() <= kHeaderBytes) return;
  (*bytes)[kHeaderBytes + offset % (bytes->size() - kHeaderBytes)] ^= difference;
  seal(bytes);
}

bool write_some(platform::Link* link, int stream, std::vector<std::uint8_t>* bytes) {
  platform::Error error;
  std::size_t count = 0;
  if (bytes->empty()) return true;
  platform::LinkResult result = platform::kNullLink.write(link, stream, bytes->data(), bytes->size(), &count, &error);
  bytes->erase(bytes->begin(), bytes->begin() + static_cast<std::ptrdiff_t>(count));
  return result != platform::LinkResult::failed;
}

}  // namespace pocketray
