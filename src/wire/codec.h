// Codec: rows of pixels ↔ bytes of a row_chunk. Blocks of pixels are predicted from the previous frame, with motion, or
// from their neighbours; differences go through an adaptive range coder, whose statistics last as long as the
// connection. PROTOCOL.md has the format. All memory comes from an arena, once. Not thread-safe.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "wire/message.h"
#include "wire/pixel_model.h"

namespace pocketray {

// Bit of RowChunk::encoding: the rows are coded; otherwise they are raw pixels.
constexpr std::uint8_t kEncodingCoded = 1;
// The upper bits number the chunks of a connection, which exposes repeated and reordered chunks. The sender adds them
// to the result of encode_rows(); the receiver removes them before decode_rows(). take_chunk_number() returns false if
// the number is not that of the `count` chunks before.
constexpr int kChunkNumberShift = 3;
inline void add_chunk_number(RowChunk* chunk, std::uint32_t count) {
  chunk->encoding = static_cast<std::uint8_t>(chunk->encoding | count << kChunkNumberShift);
}
[[nodiscard]] inline bool take_chunk_number(RowChunk* chunk, std::uint32_t count) {
  std::uint8_t number = chunk->encoding >> kChunkNumberShift;
  chunk->encoding &= kEncodingCoded;
  return number == (count & 0xFFu >> kChunkNumberShift);
}

struct CodecShape {
  std::uint32_t width = 0, height = 0;  // pixels
  std::uint32_t chunk_rows_max = 1;
  WireFormat format = WireFormat::rgb565;
};

// Returns whether a codec fits the shape: sides up to kImageSideMax, a chunk of at least one row fits a message.
bool codec_shape_valid(const CodecShape& shape);

// Chosen: about the size of areas that move together on a small screen, and the height of most chunks. Measured by
// codec_frames_test.
constexpr std::uint32_t kBlockColumns = 8, kBlockRows = 8;

// Offset in pixels from a block to its prediction in the previous frame.
struct BlockMotion {
  std::int16_t x = 0, y = 0;
};
inline bool operator==(BlockMotion a, BlockMotion b) { return a.x == b.x && a.y == b.y; }

enum class BlockKind : std::uint8_t {
  spatial,   // predicted from neighbours
  temporal,  // predicted from the previous frame
  exact,     // equals the previous frame, moved
};
struct BlockChoice {
  BlockKind kind = BlockKind::spatial;
  BlockMotion motion;  // spatial block: the motion it would have
};

// Both ends start with a black picture and update it identically. They keep the last two versions of every row: a frame
// is predicted from the previous one, whichever of its rows arrived first.
struct CodecState {
  CodecShape shape;
  Array<std::uint8_t> versions;     // 2 × height × width × pixel_bytes(format), and a black row
  Array<std::uint8_t> current;      // per row: the version sent last
  Array<std::uint32_t> row_frames;  // per row: number of the frame in which it was sent last
  std::uint32_t frame = 0;          // frame of the last chunk
  CodeModels models;
  Array<BlockChoice> blocks;             // per column of blocks: the one coded last
  Array<std::uint8_t> differs;           // per column: whether the pixel coded last differed; one more at either end
  std::uint8_t rows_differ[kBlockRows];  // per row of the block beside: last pixel differs (bit 0), any does (bit 1)
  bool broken = false;
};

// Upper bound of an encoded chunk of row_count rows; the size of the sender's buffer.
std::uint32_t encoded_bytes_max(const CodecShape& shape, std::uint32_t row_count);

constexpr std::uint32_t kChunkPixelsMax = 1u << 18;

// ---- sender

struct RowEncoder {
  CodecState state;
};
std::size_t row_encoder_need(const CodecShape& shape);
// Allocates the encoder in the arena.
void make_row_encoder(const CodecShape& shape, Arena* arena, RowEncoder** encoder);
// Resets the encoder for another connection.
void restart_row_encoder(RowEncoder* encoder);
// Encodes rows [row_begin, row_begin + row_count) of a frame from `pixels`, which points at the first of them; rows are
// unpadded. RowCoding::raw codes only chunks without changes. Writes at most encoded_bytes_max() to `bytes`; returns
// the number written and sets *encoding. The encoder's picture then holds the rows as the receiver gets them.
std::uint32_t encode_rows(RowEncoder* encoder, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count,
                          const std::uint8_t* pixels, RowCoding coding, std::uint8_t* bytes, std::uint8_t* encoding);

// ---- receiver

struct RowDecoder {
  CodecState state;
};
std::size_t row_decoder_need(const CodecShape& shape);
void make_row_decoder(const CodecShape& shape, Arena* arena, RowDecoder** decoder);
void restart_row_decoder(RowDecoder* decoder);
// Decodes a chunk. Must be called for every chunk of the connection in the order sent, wanted or not. Returns true if
// the rows are in the decoder's picture. On false, no encoder wrote these bytes; the picture may be corrupt and the
// decoder is unusable until restarted: end the connection.
[[nodiscard]] bool decode_rows(RowDecoder* decoder, const RowChunk& chunk);

// Returns whether every channel of every pixel agrees within `tolerance` levels.
bool pixels_close(WireFormat format, const std::uint8_t* a, const std::uint8_t* b, std::uint32_t pixel_count,
                  std::uint32_t tolerance);

// First byte of a row in the picture.
inline std::uint8_t* picture_row(const CodecState& s, std::uint32_t row) {
  return s.versions.data +
         (std::size_t(s.current[row]) * s.shape.height + row) * s.shape.width * pixel_bytes(s.shape.format);
}

}  // namespace pocketray
