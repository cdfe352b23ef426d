// Bytes of a hostile peer: messages, and the rows in them.
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "base/check.h"
#include "fuzz/fuzz.h"
#include "wire/codec.h"
#include "wire/message.h"

POCKETRAY_FUZZ_TARGET(fuzz_message)

namespace pocketray {
namespace {

using Bytes = std::vector<std::uint8_t>;

// A codec for small pictures, restarted for every input.
struct SmallCodec {
  CodecShape shape;
  Bytes block, chunk;
  RowEncoder* encoder = nullptr;
  RowDecoder* decoder = nullptr;
  FrameRequest request;  // the last

  explicit SmallCodec(WireFormat format)
      : shape{24, 16, 4, format},
        block(row_encoder_need(shape) + row_decoder_need(shape) + kArenaAlignment),
        chunk(encoded_bytes_max(shape, shape.chunk_rows_max)) {
    Arena arena = make_arena("fuzz", block.data(), block.size());
    make_row_encoder(shape, &arena, &encoder);
    make_row_decoder(shape, &arena, &decoder);
  }
};
SmallCodec& codec_of(WireFormat format) {
  static std::unique_ptr<SmallCodec> codecs[2];
  std::unique_ptr<SmallCodec>& codec = codecs[static_cast<int>(format)];
  if (!codec) codec = std::make_unique<SmallCodec>(format);
  restart_row_encoder(codec->encoder);
  restart_row_decoder(codec->decoder);
  codec->request = FrameRequest();
  return *codec;
}

// A change is built only where a receiver that has the other request makes exactly this one of it.
void check_change(const FrameRequest& request, const FrameRequest& before) {
  if (!is_change(request, before)) return;
  Message change, read, made, wanted;
  change.type = MessageType::frame_change, change.frame_request = request;
  Bytes bytes(message_bytes(change));
  encode_message(change, bytes.data());
  CHECK(decode_message(bytes.data(), bytes.size(), kMessageBytesMax, &read).state == DecodeState::message);
  made.type = wanted.type = MessageType::frame_request;
  made.frame_request = before, wanted.frame_request = request;
  take_change(read.frame_request, &made.frame_request);
  Bytes made_bytes(message_bytes(made)), wanted_bytes(message_bytes(wanted));
  encode_message(made, made_bytes.data()), encode_message(wanted, wanted_bytes.data());
  CHECK(made_bytes == wanted_bytes);
  ++fuzz_counts.changes;
}

// Of requests that follow each other, each as a change of the other.
void take_request(const Message& message, FrameRequest* last) {
  FrameRequest request = message.frame_request;
  if (message.type == MessageType::frame_change) request = *last, take_change(message.frame_request, &request);
  check_change(request, *last), check_change(*last, request);
  *last = request;
}

// Takes a message off the front, as a copy of exact size so that a sanitizer notices overreads. False if there is none.
bool take_message(const std::uint8_t** bytes, std::size_t* byte_count, SmallCodec* codec) {
  Message message;
  Decoded decoded = decode_message(*bytes, *byte_count, kMessageBytesMax, &message);
  if (decoded.state == DecodeState::malformed) CHECK_EQ(decoded.byte_count, 0u);
  if (decoded.state == DecodeState::need_more) CHECK_GT(decoded.byte_count, *byte_count);
  if (decoded.state != DecodeState::message) return false;
  CHECK_LE(decoded.byte_count, *byte_count);
  Bytes alone(*bytes, *bytes + decoded.byte_count);
  CHECK(decode_message(alone.data(), alone.size(), kMessageBytesMax, &message).state == DecodeState::message);
  if (message.type != MessageType::hello || message.hello.version == kWireVersion) {
    Bytes again(message_bytes(message));
    encode_message(message, again.data());
    CHECK(again == alone);
  }
  if (message.type == MessageType::frame_request || message.type == MessageType::frame_change)
    take_request(message, &codec->request);
  if (message.type == MessageType::row_chunk) fuzz_counts.chunks += decode_rows(codec->decoder, message.row_chunk);
  ++fuzz_counts.messages;
  *bytes += decoded.byte_count, *byte_count -= decoded.byte_count;
  return true;
}

void read_stream(const std::uint8_t* bytes, std::size_t byte_count) {
  SmallCodec& codec = codec_of(WireFormat::rgb565);
  while (take_message(&bytes, &byte_count, &codec)) {
  }
}

void read_sealed(const std::uint8_t* bytes, std::size_t byte_count) {
  SmallCodec& codec = codec_of(WireFormat::rgb565);
  while (byte_count >= 3) {
    std::size_t length = std::min<std::size_t>(bytes[1] | bytes[2] << 8, byte_count - 3);
    Bytes message(kHeaderBytes + length);
    message[0] = bytes[0];
    message[1] = static_cast<std::uint8_t>(length), message[2] = static_cast<std::uint8_t>(length >> 8);
    std::copy_n(bytes + 3, length, message.begin() + kHeaderBytes);
    uLong sum = crc32(crc32(0, message.data(), 4), message.data() + kHeaderBytes, static_cast<uInt>(length));
    for (std::uint32_t i = 0; i < 4; ++i) message[4 + i] = static_cast<std::uint8_t>(sum >> 8 * i);
    const std::uint8_t* at = message.data();
    std::size_t left = message.size();
    take_message(&at, &left, &codec);
    bytes += 3 + length, byte_count -= 3 + length;
  }
}

// Format; then chunks: row, rows, encoding with the parity of the frame above it, length in two bytes, bytes.
void read_chunks(const std::uint8_t* bytes, std::size_t byte_count) {
  if (byte_count == 0) return;
  SmallCodec& codec = codec_of(bytes[0] & 1 ? WireFormat::rgb888 : WireFormat::rgb565);
  for (++bytes, --byte_count; byte_count >= 5;) {
    std::size_t length = std::min<std::size_t>(bytes[3] | bytes[4] << 8, byte_count - 5);
    Bytes alone(bytes + 5, bytes + 5 + length);
    RowChunk chunk;
    chunk.row_begin = bytes[0], chunk.row_count = bytes[1], chunk.encoding = bytes[2] & 127;
    chunk.frame = 1 + (bytes[2] >> 7);
    chunk.bytes = {alone.data(), static_cast<std::uint32_t>(length)};
    if (!decode_rows(codec.decoder, chunk)) return;
    ++fuzz_counts.chunks;
    bytes += 5 + length, byte_count -= 5 + length;
  }
}

// Format; then edits of a picture, each sent immediately: row, rows, coding with the parity of the frame above it,
// length, bytes repeated over the rows.
void send_pictures(const std::uint8_t* bytes, std::size_t byte_count) {
  if (byte_count == 0) return;
  SmallCodec& codec = codec_of(bytes[0] & 1 ? WireFormat::rgb888 : WireFormat::rgb565);
  std::size_t row_bytes = codec.shape.width * pixel_bytes(codec.shape.format);
  Bytes picture(row_bytes * codec.shape.height);
  for (++bytes, --byte_count; byte_count >= 4;) {
    std::uint32_t row_count = 1 + bytes[1] % codec.shape.chunk_rows_max;
    std::uint32_t row_begin = bytes[0] % (codec.shape.height - row_count + 1);
    const RowCoding coding = static_cast<RowCoding>((bytes[2] & 127) % 3);
    const std::uint32_t frame = 1 + (bytes[2] >> 7);
    std::size_t length = std::min<std::size_t>(bytes[3], byte_count - 4);
    for (std::size_t i = 0; length > 0 && i < row_count * row_bytes; ++i)
      picture[row_begin * row_bytes + i] ^= bytes[4 + i % length];
    RowChunk chunk;
    chunk.row_begin = static_cast<std::uint16_t>(row_begin), chunk.row_count = static_cast<std::uint16_t>(row_count);
    chunk.frame = frame;
    std::uint32_t count =
        encode_rows(codec.encoder, frame, row_begin, row_count, picture.data() + row_begin * row_bytes, coding,
                    codec.chunk.data(), &chunk.encoding);
    CHECK_LE(count, encoded_bytes_max(codec.shape, row_count));
    chunk.bytes = {codec.chunk.data(), count};
    CHECK(decode_rows(codec.decoder, chunk));
    for (std::uint32_t row = row_begin; row < row_begin + row_count; ++row) {
      const std::uint8_t* decoded = picture_row(codec.decoder->state, row);
      CHECK(std::memcmp(decoded, picture_row(codec.encoder->state, row), row_bytes) == 0);
      if (coding != RowCoding::near_lossless)
        CHECK(std::memcmp(decoded, picture.data() + row * row_bytes, row_bytes) == 0);
    }
    ++fuzz_counts.pictures;
    bytes += 4 + length, byte_count -= 4 + length;
  }
}

}  // namespace

void fuzz_message(const std::uint8_t* bytes, std::size_t byte_count) {
  if (byte_count == 0) return;
  std::uint8_t kind = bytes[0] & 3;
  ++bytes, --byte_count;
  if (kind == 0) read_stream(bytes, byte_count);
  if (kind == 1) read_sealed(bytes, byte_count);
  if (kind == 2) read_chunks(bytes, byte_count);
  if (kind == 3) send_pictures(bytes, byte_count);
}

}  // namespace pocketray
