// Codec: rows of pixels ↔ bytes of a row_chunk. Only what changed since the rows were last sent travels, as differences
// to what its neighbours predict where that is smaller, through one deflate stream [RFC 1951] that lasts as long as the
// connection: what was sent before is the dictionary of what follows. PROTOCOL.md has the format.
// All memory is taken from an arena once; zlib's comes from a part of it. Not for several threads at once.
#pragma once
#include <zlib.h>

#include "base/arena.h"
#include "base/status.h"
#include "wire/message.h"

namespace pocketray {

// Bits of RowChunk::encoding.
constexpr std::uint8_t kEncodingPredicted = 1, kEncodingDeflated = 2;
// The bits above count the chunks of a connection, so that one that comes twice or out of turn is known. The sender
// adds them to what encode_rows() gives; the receiver takes them off before decode_rows(): false where `count`, of
// those before, is another.
constexpr int kChunkNumberShift = 2;
inline void add_chunk_number(RowChunk* chunk, std::uint32_t count) {
  chunk->encoding = static_cast<std::uint8_t>(chunk->encoding | count << kChunkNumberShift);
}
[[nodiscard]] inline bool take_chunk_number(RowChunk* chunk, std::uint32_t count) {
  std::uint8_t number = chunk->encoding >> kChunkNumberShift;
  chunk->encoding &= kEncodingPredicted | kEncodingDeflated;
  return number == (count & 0xFFu >> kChunkNumberShift);
}

struct CodecShape {
  std::uint32_t width = 0, height = 0;  // pixels
  std::uint32_t chunk_rows_max = 1;
  WireFormat format = WireFormat::rgb565;
};

// Whether a codec can be made for it: sides within kImageSideMax, chunks of at least a row that fit into a message.
bool codec_shape_valid(const CodecShape& shape);

// Both ends begin with a black picture and change it alike; what an end holds, its peer holds.
struct CodecState {
  CodecShape shape;
  Array<std::uint8_t> picture;  // height × width × pixel_bytes(format), without padding: rows as last sent
  Array<std::uint8_t> runs;     // scratch: where pixels changed
  Array<std::uint8_t> body;     // scratch: a chunk before deflation
  Arena zlib_arena;
  z_stream stream;  // zlib knows its address: a state stays where make_* has put it
  int level;
  bool broken;
};

// The most that a chunk of row_count rows takes, encoded; a size for the sender's buffer.
std::uint32_t encoded_bytes_max(const CodecShape& shape, std::uint32_t row_count);

constexpr std::uint32_t kChunkPixelsMax = 1u << 18;

// ---- sender

struct RowEncoder {
  CodecState state;
};
std::size_t row_encoder_need(const CodecShape& shape);
// The encoder lies in the arena. Fails where this zlib needs more memory than row_encoder_need() plans for it.
Status make_row_encoder(const CodecShape& shape, Arena* arena, RowEncoder** encoder);
// Ready for another connection, as when it was made.
void restart_row_encoder(RowEncoder* encoder);
// Encodes rows [row_begin, row_begin + row_count) from `pixels`, where the first of them begins; they follow each other
// without padding. Level 0 leaves the bytes as they are, 1 to 9 deflate them (zlib's levels) where that is worth while.
// Writes at most encoded_bytes_max() to `bytes`; returns how many, and *encoding.
std::uint32_t encode_rows(RowEncoder* encoder, std::uint32_t row_begin, std::uint32_t row_count,
                          const std::uint8_t* pixels, int level, std::uint8_t* bytes, std::uint8_t* encoding);

// ---- receiver

struct RowDecoder {
  CodecState state;
};
std::size_t row_decoder_need(const CodecShape& shape);
Status make_row_decoder(const CodecShape& shape, Arena* arena, RowDecoder** decoder);
void restart_row_decoder(RowDecoder* decoder);
// Decodes a chunk, every one of the connection in the order they were sent, wanted or not. True: the rows are in
// decoder->state.picture. False: the bytes are not what an encoder writes, the picture may be spoilt and the decoder is
// of no use until it is restarted: end the connection. Inflates to no more than a chunk of these rows can need.
[[nodiscard]] bool decode_rows(RowDecoder* decoder, const RowChunk& chunk);

// Where a row begins in the picture.
inline std::uint8_t* picture_row(const CodecState& state, std::uint32_t row) {
  return state.picture.data + std::size_t(row) * state.shape.width * pixel_bytes(state.shape.format);
}

}  // namespace pocketray
