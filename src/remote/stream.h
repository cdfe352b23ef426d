// MessageStream: messages over one connection of a link, in the caller's memory. Never blocks.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "platform/link.h"
#include "wire/message.h"

namespace pocketray {

struct MessageStream {
  platform::Link* link = nullptr;
  int stream = -1;                       // −1: closed
  Array<std::uint8_t> in, out;           // received but not taken; waiting to be sent
  std::size_t in_begin = 0, in_end = 0;  // in `in`
  std::size_t out_begin = 0, out_end = 0;
  std::uint32_t message_bytes_max = 0;        // longest message accepted; 0: as long as `in`
  std::uint64_t bytes_in = 0, bytes_out = 0;  // of this connection, on the wire
  bool ended = false;                         // the peer will send nothing more
};

// `in_bytes`: longest message accepted, with header; `out_bytes`: capacity of the send queue.
std::size_t message_stream_need(std::size_t in_bytes, std::size_t out_bytes);
MessageStream make_message_stream(std::size_t in_bytes, std::size_t out_bytes, Arena* arena);

// Starts over with a connection of the link.
void start_message_stream(MessageStream* stream, platform::Link* link, int connection);

// Errors from here on do not name the peer: callers do, since their users know it.

// Begins to connect, and starts over with that connection.
bool connect_message_stream(MessageStream* stream, platform::Link* link, const platform::LinkAddress& address,
                            std::uint64_t timeout_ns, platform::Error* error);
// Wraps the link's connected().
platform::LinkResult connected_message_stream(MessageStream* stream, platform::Error* error);
void close_message_stream(MessageStream* stream);

// Sends and receives as far as there is room. Returns false if the connection is lost; `error` says why.
bool pump_message_stream(MessageStream* stream, platform::Error* error);
// Only sends, and only receives. Returns as above, but a peer may have sent its last byte.
bool flush_message_stream(MessageStream* stream, platform::Error* error);
bool read_message_stream(MessageStream* stream, platform::Error* error);

// Takes the next complete message; its arrays are valid until the next call with the stream. need_more: there is none;
// malformed: invalid bytes, so the caller must end the connection.
DecodeState take_message(MessageStream* stream, Message* message);

inline std::size_t queued_bytes(const MessageStream& stream) { return stream.out_end - stream.out_begin; }
// Total queued since the connection began, sent or not.
inline std::uint64_t queued_in_all(const MessageStream& stream) { return stream.bytes_out + queued_bytes(stream); }
inline std::size_t output_room(const MessageStream& stream) { return stream.out.count - queued_bytes(stream); }
inline std::size_t input_bytes(const MessageStream& stream) { return stream.in_end - stream.in_begin; }
// Returns contiguous room for `byte_count` bytes behind the queue; that much must be free. The next message goes there.
std::uint8_t* reserve_output(MessageStream* stream, std::size_t byte_count);
// Discards the input.
inline void drop_input(MessageStream* stream) { stream->in_begin = stream->in_end = 0; }
// Queues a message; false if it does not fit.
[[nodiscard]] bool send_message(MessageStream* stream, const Message& message);

// Why take_message() called the input malformed: a peer that uses TLS answers with TLS records.
const char* malformed_text(const MessageStream& stream);

// Fails if the peer's hello has another protocol version.
Status check_version(const Hello& hello);

}  // namespace pocketray
