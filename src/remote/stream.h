// MessageStream: messages over one connection of a link. Memory is the caller's; nothing waits.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "platform/link.h"
#include "wire/message.h"

namespace pocketray {

struct MessageStream {
  platform::Link* link = nullptr;
  int stream = -1;                       // −1: closed
  Array<std::uint8_t> in, out;           // what has come and was not taken; what is to go
  std::size_t in_begin = 0, in_end = 0;  // in `in`
  std::size_t out_begin = 0, out_end = 0;
  std::uint32_t message_bytes_max = 0;        // longest message taken; 0: as long as `in`
  std::uint64_t bytes_in = 0, bytes_out = 0;  // of this connection, on the wire
  bool ended = false;                         // the peer sends nothing more
};

// `in_bytes`: the longest message taken, header included; `out_bytes`: what may wait to be sent.
std::size_t message_stream_need(std::size_t in_bytes, std::size_t out_bytes);
MessageStream make_message_stream(std::size_t in_bytes, std::size_t out_bytes, Arena* arena);

// Begins anew with a connection of the link.
void start_message_stream(MessageStream* stream, platform::Link* link, int connection);
void close_message_stream(MessageStream* stream);

// Sends what waits as far as there is room, and takes what has come as far as there is room. False: the connection is
// lost, `error` says why.
bool pump_message_stream(MessageStream* stream, platform::Error* error);
// Sends alone, and receives alone; false as above, but a peer that sends nothing more is not lost.
bool flush_message_stream(MessageStream* stream, platform::Error* error);
bool read_message_stream(MessageStream* stream, platform::Error* error);

// The next message that is whole, taken off; its arrays hold until the next call with the stream. need_more where there
// is none, malformed where the bytes are not what a peer may send: end the connection.
DecodeState take_message(MessageStream* stream, Message* message);

inline std::size_t queued_bytes(const MessageStream& stream) { return stream.out_end - stream.out_begin; }
// Since the connection began.
inline std::uint64_t queued_in_all(const MessageStream& stream) { return stream.bytes_out + queued_bytes(stream); }
inline std::size_t output_room(const MessageStream& stream) { return stream.out.count - queued_bytes(stream); }
inline std::size_t input_bytes(const MessageStream& stream) { return stream.in_end - stream.in_begin; }
// Room for `byte_count` bytes in a row behind what is queued, of which there must be as many; the next message goes
// there.
std::uint8_t* reserve_output(MessageStream* stream, std::size_t byte_count);
// Forgets what has come.
inline void drop_input(MessageStream* stream) { stream->in_begin = stream->in_end = 0; }
// Queues a message; false where there is no room for it.
[[nodiscard]] bool send_message(MessageStream* stream, const Message& message);

// Fails where the peer's hello is of another version of the protocol.
Status check_version(const Hello& hello);

}  // namespace pocketray
