// A server scripted by a test, over a simulated link: one that lies, floods or falls silent.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "platform/null/net/null_link.h"
#include "wire/codec.h"

namespace pocketray {

struct FakeServer;
struct FakeLink : platform::LinkBackend {
  FakeServer* server = nullptr;
};

// Works whenever the device waits and, if it `floods`, also whenever the device reads, so that input never ends.
struct FakeServer {
  using Answer = std::function<std::vector<Message>(const Message&)>;
  std::vector<std::max_align_t> memory;
  FakeLink backend;
  platform::Link* link = nullptr;
  platform::LinkAddress address;
  int listener = -1, stream = -1;
  std::vector<std::uint8_t> in, out;
  Answer answer;
  std::function<std::vector<std::uint8_t>()> flood;  // bytes to send whenever its queue is empty; empty: none
  bool accepts = true, reads = true;
  std::uint32_t connection_count = 0;
  std::uint64_t bytes_sent = 0;

  explicit FakeServer(const Answer& answer, const platform::NullLinkSettings& line = platform::NullLinkSettings());
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::uint64_t now() { return platform::kNullLink.now_ns(link); }
  void step();
  void hang_up();  // then waits for the next connection
};

// Black rows as a server would send them: a valid stream of chunks for any request.
struct RowSource {
  std::vector<std::uint8_t> memory;
  Arena arena;
  RowEncoder* encoder = nullptr;
  std::vector<std::unique_ptr<std::vector<std::uint8_t>>> bytes;  // of the chunks made
  std::uint32_t chunk_count = 0;
  std::uint32_t width, height;
  WireFormat format;

  RowSource(std::uint32_t width, std::uint32_t height, WireFormat format);
  void restart();  // for a new connection
  // `shade`: of all pixels; a different one makes the rows differ.
  Message chunk(std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count, std::uint8_t shade = 0);
  // All requested rows.
  std::vector<Message> rows(const FrameRequest& request, std::uint8_t shade = 0);
};

Message hello_of_server();

}  // namespace pocketray
