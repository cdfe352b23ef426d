// Codec: rows of pixels ↔ bytes of a row_chunk. Sends only pixels that changed since the rows were last sent, as
// differences from a prediction by their neighbours where that is smaller, through one deflate stream [RFC 1951] that
// lasts as long as the connection: earlier bytes are the dictionary of later ones. PROTOCOL.md has the format.
// All memory comes from an arena once; zlib's from a part of it. Not thread-safe.
#pragma once
#include <zlib.h>

#include "base/arena.h"
#include "base/status.h"
#include "wire/message.h"

namespace pocketray {

// Bits of RowChunk::encoding.
constexpr std::uint8_t kEncodingPredicted = 1, kEncodingDeflated = 2;
// The bits above number the chunks of a connection, which exposes repeated and reordered ones. The sender adds them to
// the result of encode_rows(); the receiver removes them before decode_rows(). False if `count`, the number of chunks
// before, differs.
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

// Whether a codec can be made for the shape: sides within kImageSideMax, chunks of at least one row that fit a message.
bool codec_shape_valid(const CodecShape& shape);

// Both ends start with a black picture and change it alike, so that they always hold the same. A row that is sent for
// the first time is sent whole.
struct CodecState {
  CodecShape shape;
  Array<std::uint8_t> picture;  // height × width × pixel_bytes(format), unpadded: rows as last sent
  Array<std::uint8_t> sent;     // 1 for each row that was sent
  Array<std::uint8_t> runs;     // scratch: runs of changed pixels
  Array<std::uint8_t> body;     // scratch: a chunk before deflation
  Arena zlib_arena;
  z_stream stream;  // zlib keeps its address: a state must stay where make_* put it
  int level;
  bool broken;
};

// Upper bound of an encoded chunk of row_count rows; the size of the sender's buffer.
std::uint32_t encoded_bytes_max(const CodecShape& shape, std::uint32_t row_count);

constexpr std::uint32_t kChunkPixelsMax = 1u << 18;

// ---- sender

struct RowEncoder {
  CodecState state;
};
std::size_t row_encoder_need(const CodecShape& shape);
// The encoder lies in the arena. Fails if this zlib needs more memory than row_encoder_need() plans for it.
Status make_row_encoder(const CodecShape& shape, Arena* arena, RowEncoder** encoder);
// Resets the encoder for another connection.
void restart_row_encoder(RowEncoder* encoder);
// Encodes rows [row_begin, row_begin + row_count) from `pixels`, which points at the first of them; rows are unpadded.
// Level 0 does not compress, 1 to 9 deflate (zlib's levels) where it pays. Writes at most encoded_bytes_max() to
// `bytes`; returns the number written and sets *encoding.
std::uint32_t encode_rows(RowEncoder* encoder, std::uint32_t row_begin, std::uint32_t row_count,
                          const std::uint8_t* pixels, int level, std::uint8_t* bytes, std::uint8_t* encoding);

// ---- receiver

struct RowDecoder {
  CodecState state;
};
std::size_t row_decoder_need(const CodecShape& shape);
Status make_row_decoder(const CodecShape& shape, Arena* arena, RowDecoder** decoder);
void restart_row_decoder(RowDecoder* decoder);
// Decodes a chunk. Must be called for every chunk of the connection in the order sent, wanted or not. True: the rows
// are in decoder->state.picture. False: no encoder wrote these bytes; the picture may be corrupt and the decoder is
// unusable until restarted: end the connection. Never inflates to more than a chunk of these rows can need.
[[nodiscard]] bool decode_rows(RowDecoder* decoder, const RowChunk& chunk);

// First byte of a row in the picture.
inline std::uint8_t* picture_row(const CodecState& state, std::uint32_t row) {
  return state.picture.data + std::size_t(row) * state.shape.width * pixel_bytes(state.shape.format);
}

}  // namespace pocketray
