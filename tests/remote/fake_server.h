// A server that answers as a test tells it to, over a simulated link: what a device does with one that lies, floods or
// falls silent.
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

// Works whenever the device waits, and where it `floods` whenever the device reads, too: then there is always more.
struct FakeServer {
  using Answer = std::function<std::vector<Message>(const Message&)>;
  std::vector<std::max_align_t> memory;
  FakeLink backend;
  platform::Link* link = nullptr;
  platform::LinkAddress address;
  int listener = -1, stream = -1;
  std::vector<std::uint8_t> in, out;
  Answer answer;
  std::function<std::vector<std::uint8_t>()> flood;  // bytes to send whenever nothing waits to be sent; empty: none
  bool accepts = true, reads = true;
  std::uint32_t connection_count = 0;
  std::uint64_t bytes_sent = 0;

  explicit FakeServer(const Answer& answer, const platform::NullLinkSettings& line = platform::NullLinkSettings());
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::uint64_t now() { return platform::kNullLink.now_ns(link); }
  void step();
  void hang_up();  // and wait for the next connection
};

// Black rows as a server sends them: a valid stream of chunks, whatever was asked for.
struct RowSource {
  std::vector<std::uint8_t> memory;
  Arena arena;
  RowEncoder* encoder = nullptr;
  std::vector<std::unique_ptr<std::vector<std::uint8_t>>> bytes;  // of the chunks made
  std::uint32_t chunk_count = 0;
  std::uint32_t width, height;
  WireFormat format;

  RowSource(std::uint32_t width, std::uint32_t height, WireFormat format);
  void restart();  // with a connection
  // `shade`: of all pixels; another one than before makes the rows differ.
  Message chunk(std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count, std::uint8_t shade = 0);
  // All rows that were asked for.
  std::vector<Message> rows(const FrameRequest& request, std::uint8_t shade = 0);
};

Message hello_of_server();

}  // namespace pocketray
