#include "fake_server.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/scripted_client.h"
#include "wire/row_sequence.h"

namespace pocketray {
namespace {

constexpr int kStreams = 16;
constexpr std::uint32_t kPixelPs = 100'000;

FakeServer* server_of(const platform::Link* link) { return static_cast<const FakeLink*>(link->backend)->server; }

int step_and_poll(platform::Link* link, platform::LinkWait* waits, int wait_count, std::uint64_t timeout_ns) {
  server_of(link)->step();
  return platform::kNullLink.poll(link, waits, wait_count, std::min(timeout_ns, kMs));
}

platform::LinkResult step_and_read(platform::Link* link, int stream, void* bytes, std::size_t byte_count_max,
                                   std::size_t* byte_count, platform::Error* error) {
  FakeServer* server = server_of(link);
  if (server->flood) server->step();
  return platform::kNullLink.read(link, stream, bytes, byte_count_max, byte_count, error);
}

}  // namespace

FakeServer::FakeServer(const Answer& answer_, const platform::NullLinkSettings& line) : answer(answer_) {
  const platform::LinkBackend& net = platform::kNullLink;
  platform::LinkOptions options;
  options.stream_count_max = kStreams;
  options.memory_bytes = null_link_need(kStreams, line);
  memory.resize(options.memory_bytes / sizeof(std::max_align_t) + 1);
  options.memory = memory.data();
  platform::Error error;
  link = null_link_open(options, line, &error);
  REQUIRE(link != nullptr);
  REQUIRE(net.resolve(":0", &address, &error));
  listener = net.listen(link, address, &error);
  REQUIRE(net.resolve(net.stream_name(link, listener), &address, &error));
  static_cast<platform::LinkBackend&>(backend) = net;
  backend.poll = step_and_poll;
  backend.read = step_and_read;
  backend.server = this;
  link->backend = &backend;
}

FakeServer::~FakeServer() { platform::kNullLink.close_all(link); }

void FakeServer::hang_up() {
  if (stream >= 0) platform::kNullLink.close(link, stream);
  stream = -1;
  in.clear(), out.clear();
}

void FakeServer::step() {
  const platform::LinkBackend& net = platform::kNullLink;
  platform::Error error;
  if (stream < 0 && accepts && net.accept(link, listener, &stream, &error) == platform::LinkResult::done)
    ++connection_count;
  if (stream < 0) return;
  std::uint8_t bytes[4096];
  std::size_t count = 0;
  platform::LinkResult result = platform::LinkResult::later;
  if (reads) result = net.read(link, stream, bytes, sizeof bytes, &count, &error);
  if (result == platform::LinkResult::failed || result == platform::LinkResult::ended) return hang_up();
  in.insert(in.end(), bytes, bytes + count);
  Message message;
  for (Decoded decoded;
       (decoded = decode_message(in.data(), in.size(), 4096, &message)).state == DecodeState::message;) {
    for (const Message& reply : answer(message)) {
      std::vector<std::uint8_t> reply_bytes = bytes_of(reply);
      out.insert(out.end(), reply_bytes.begin(), reply_bytes.end());
    }
    if (stream < 0) return;  // it has hung up
    in.erase(in.begin(), in.begin() + decoded.byte_count);
  }
  if (out.empty() && flood) out = flood();
  if (out.empty()) return;
  result = net.write(link, stream, out.data(), out.size(), &count, &error);
  if (result == platform::LinkResult::failed) return hang_up();
  out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
  bytes_sent += count;
}

RowSource::RowSource(std::uint32_t width_, std::uint32_t height_, WireFormat format_)
    : width(width_), height(height_), format(format_) {
  CodecShape shape = {width, height, std::min(32u, height), format};
  memory.resize(row_encoder_need(shape) + kArenaAlignment);
  arena = make_arena("rows", memory.data(), memory.size());
  make_row_encoder(shape, &arena, &encoder);
}

void RowSource::restart() {
  restart_row_encoder(encoder);
  chunk_count = 0;
  bytes.clear();
}

Message RowSource::chunk(std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count, std::uint8_t shade) {
  std::vector<std::uint8_t> pixels(std::size_t(width) * row_count * pixel_bytes(format), shade);
  CodecShape shape = {width, height, std::min(32u, height), format};
  bytes.push_back(std::make_unique<std::vector<std::uint8_t>>(encoded_bytes_max(shape, row_count)));
  Message message;
  message.type = MessageType::row_chunk;
  RowChunk* c = &message.row_chunk;
  c->frame = frame;
  c->row_begin = static_cast<std::uint16_t>(row_begin), c->row_count = static_cast<std::uint16_t>(row_count);
  c->pixel_ps = kPixelPs, c->traced = 255;
  std::uint32_t count = encode_rows(encoder, frame, row_begin, row_count, pixels.data(), RowCoding::raw,
                                    bytes.back()->data(), &c->encoding);
  c->bytes = {bytes.back()->data(), count};
  add_chunk_number(c, chunk_count++);
  return message;
}

std::vector<Message> RowSource::rows(const FrameRequest& request, std::uint8_t shade) {
  std::vector<Message> chunks;
  for (RowSequence at = first_rows(request); has_rows(at);) {
    const std::uint32_t count = std::min<std::uint32_t>(next_chunk_rows(request, at), 8);
    chunks.push_back(chunk(request.frame, at.row_end - count, count, shade));
    pass_rows(request, count, &at);
  }
  return chunks;
}

Message hello_of_server() {
  Message message;
  message.type = MessageType::hello;
  message.hello = {kWireVersion, 2048, 512, 0};
  return message;
}

}  // namespace pocketray
