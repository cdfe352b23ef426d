#include "remote/stream.h"

#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

// Moves the remaining bytes to the front.
void compact(Array<std::uint8_t> bytes, std::size_t* begin, std::size_t* end) {
  CHECK(*begin <= *end && *end <= bytes.count);
  if (*begin == 0) return;
  std::memmove(bytes.data, bytes.data + *begin, *end - *begin);
  *end -= *begin, *begin = 0;
}

// Removes the name at the start of a link's error (platform/link.h).
void leave_out(const char* name, platform::Error* error) {
  const std::size_t length = std::strlen(name);
  if (length == 0 || std::strncmp(error->text, name, length) != 0) return;
  const char* rest = error->text + length;
  if (std::strncmp(rest, ": ", 2) == 0) std::memmove(error->text, rest + 2, std::strlen(rest + 2) + 1);
}

bool fail_unnamed(const MessageStream& s, platform::Error* error) {
  leave_out(s.link->backend->stream_name(s.link, s.stream), error);
  return false;
}

}  // namespace

std::size_t message_stream_need(std::size_t in_bytes, std::size_t out_bytes) {
  return arena_need<std::uint8_t>(in_bytes) + arena_need<std::uint8_t>(out_bytes);
}

MessageStream make_message_stream(std::size_t in_bytes, std::size_t out_bytes, Arena* arena) {
  CHECK_GE(in_bytes, kHeaderBytes);
  MessageStream stream;
  stream.in = arena_array<std::uint8_t>(arena, in_bytes);
  stream.out = arena_array<std::uint8_t>(arena, out_bytes);
  return stream;
}

void start_message_stream(MessageStream* s, platform::Link* link, int connection) {
  CHECK(link != nullptr && connection >= 0);
  CHECK_LT(s->stream, 0);  // the previous connection is closed
  Array<std::uint8_t> in = s->in, out = s->out;
  std::uint32_t message_bytes_max = s->message_bytes_max;
  *s = MessageStream();
  s->in = in, s->out = out, s->message_bytes_max = message_bytes_max;
  s->link = link, s->stream = connection;
}

bool connect_message_stream(MessageStream* s, platform::Link* link, const platform::LinkAddress& address,
                            std::uint64_t timeout_ns, platform::Error* error) {
  CHECK(link != nullptr && error != nullptr);
  const int connection = link->backend->connect(link, address, timeout_ns, error);
  if (connection >= 0)
    start_message_stream(s, link, connection);
  else
    leave_out(address.text, error);
  return connection >= 0;
}

platform::LinkResult connected_message_stream(MessageStream* s, platform::Error* error) {
  CHECK_GE(s->stream, 0);
  const platform::LinkResult result = s->link->backend->connected(s->link, s->stream, error);
  if (result == platform::LinkResult::failed) fail_unnamed(*s, error);
  return result;
}

void close_message_stream(MessageStream* s) {
  if (s->stream >= 0) s->link->backend->close(s->link, s->stream);
  s->stream = -1;
}

bool flush_message_stream(MessageStream* s, platform::Error* error) {
  while (queued_bytes(*s) > 0) {
    std::size_t count = 0;
    platform::LinkResult result = s->link->backend->write(s->link, s->stream, s->out.data + s->out_begin,
                                                          s->out_end - s->out_begin, &count, error);
    if (result == platform::LinkResult::later) return true;
    if (result != platform::LinkResult::done) return fail_unnamed(*s, error);
    s->out_begin += count, s->bytes_out += count;
    CHECK_LE(s->out_begin, s->out_end);  // a link sends no more than it is given
  }
  s->out_begin = s->out_end = 0;
  return true;
}

bool read_message_stream(MessageStream* s, platform::Error* error) {
  compact(s->in, &s->in_begin, &s->in_end);
  while (!s->ended && s->in_end < s->in.count) {
    std::size_t count = 0;
    platform::LinkResult result =
        s->link->backend->read(s->link, s->stream, s->in.data + s->in_end, s->in.count - s->in_end, &count, error);
    if (result == platform::LinkResult::later) return true;
    if (result == platform::LinkResult::failed) return fail_unnamed(*s, error);
    if (result == platform::LinkResult::ended) s->ended = true;
    s->in_end += count, s->bytes_in += count;
    CHECK_LE(s->in_end, s->in.count);  // a link reads no more than there is room for
  }
  return true;
}

bool pump_message_stream(MessageStream* s, platform::Error* error) {
  CHECK_GE(s->stream, 0);
  if (!flush_message_stream(s, error) || !read_message_stream(s, error)) return false;
  if (!s->ended || input_bytes(*s) > 0) return true;
  std::snprintf(error->text, sizeof error->text, "the peer has closed the connection");
  return false;
}

DecodeState take_message(MessageStream* s, Message* message) {
  std::uint32_t bytes_max = s->message_bytes_max ? s->message_bytes_max : static_cast<std::uint32_t>(s->in.count);
  Decoded decoded = decode_message(s->in.data + s->in_begin, input_bytes(*s), bytes_max, message);
  if (decoded.state == DecodeState::message) s->in_begin += decoded.byte_count;
  // A partial message that will never be completed.
  if (decoded.state == DecodeState::need_more && s->ended) s->in_begin = s->in_end;
  return decoded.state;
}

std::uint8_t* reserve_output(MessageStream* s, std::size_t byte_count) {
  CHECK_LE(byte_count, output_room(*s));
  if (byte_count > s->out.count - s->out_end) compact(s->out, &s->out_begin, &s->out_end);
  CHECK_LE(s->out_end + byte_count, s->out.count);
  return s->out.data + s->out_end;
}

bool send_message(MessageStream* s, const Message& message) {
  std::uint32_t byte_count = message_bytes(message);
  if (byte_count > output_room(*s)) return false;
  encode_message(message, reserve_output(s, byte_count));
  s->out_end += byte_count;
  CHECK_LE(s->out_end, s->out.count);
  return true;
}

const char* malformed_text(const MessageStream& s) {
  // A TLS alert or handshake [RFC 5246, sec. 6.2.1]; no message has such a type.
  const std::uint8_t* bytes = s.in.data + s.in_begin;
  const bool is_tls = input_bytes(s) >= 2 && (bytes[0] == 21 || bytes[0] == 22) && bytes[1] == 3;
  return is_tls ? "it requires a key: use the server's key (--key)" : "it sent a malformed message";
}

Status check_version(const Hello& hello) {
  if (hello.version == kWireVersion) return success();
  return failure("it speaks protocol version %u and this program version %u: update one", hello.version, kWireVersion);
}

}  // namespace pocketray
