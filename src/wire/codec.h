// Codec: rows of pixels ↔ bytes of a row_chunk. Blocks of pixels are predicted from the frame before, moved, or from
// their neighbours; what differs goes through an adaptive range coder, whose statistics last as long as the connection.
// PROTOCOL.md has the format. All memory comes from an arena once. Not thread-safe.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "wire/message.h"
#include "wire/pixel_model.h"

namespace pocketray {

// Bit of RowChunk::encoding: the rows are coded; otherwise they are pixels.
constexpr std::uint8_t kEncodingCoded = 1;
// The bits above number the chunks of a connection, which exposes repeated and reordered ones. The sender adds them to
// the result of encode_rows(); the receiver removes them before decode_rows(). False if `count`, the number of chunks
// before, differs.
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

// Whether a codec can be made for the shape: sides within kImageSideMax, chunks of at least one row that fit a message.
bool codec_shape_valid(const CodecShape& shape);

// Chosen: blocks as large as what moves alike on a small screen, and as the rows of most chunks. Measured by
// codec_frames_test.
constexpr std::uint32_t kBlockColumns = 8, kBlockRows = 8;

// Where a block was in the frame before, relative to where it is, in pixels.
struct BlockMotion {
  std::int16_t x = 0, y = 0;
};
inline bool operator==(BlockMotion a, BlockMotion b) { return a.x == b.x && a.y == b.y; }

enum class BlockKind : std::uint8_t {
  spatial,   // predicted from neighbours
  temporal,  // predicted from the frame before
  exact,     // equals the frame before, moved
};
struct BlockChoice {
  BlockKind kind = BlockKind::spatial;
  BlockMotion motion;  // of a spatial block: the one it would have
};

// Both ends start with a black picture and change it alike, so that they always hold the same. Of every row they keep
// the last two versions: those of the frame before predict a frame, whichever of its rows came first.
struct CodecState {
  CodecShape shape;
  Array<std::uint8_t> versions;     // 2 × height × width × pixel_bytes(format), and a black row
  Array<std::uint8_t> current;      // of each row, which version was sent last
  Array<std::uint32_t> row_frames;  // number of the frame in which a row was sent last
  std::uint32_t frame = 0;          // of the last chunk
  CodeModels models;
  Array<BlockChoice> blocks;    // of each column of blocks, the one coded last
  Array<std::uint8_t> differs;  // of each column, whether the pixel coded last differed; one more at either end
  std::uint8_t rows_differ[kBlockRows];  // of each row of the block beside: its last pixel (bit 0), any (bit 1)
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
// The encoder lies in the arena.
void make_row_encoder(const CodecShape& shape, Arena* arena, RowEncoder** encoder);
// Resets the encoder for another connection.
void restart_row_encoder(RowEncoder* encoder);
// Encodes rows [row_begin, row_begin + row_count) of a frame from `pixels`, which points at the first of them; rows are
// unpadded. RowCoding::raw codes only what has not changed. Writes at most encoded_bytes_max() to `bytes`; returns the
// number written and sets *encoding. The rows that the receiver gets are then in the encoder's picture.
std::uint32_t encode_rows(RowEncoder* encoder, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count,
                          const std::uint8_t* pixels, RowCoding coding, std::uint8_t* bytes, std::uint8_t* encoding);

// ---- receiver

struct RowDecoder {
  CodecState state;
};
std::size_t row_decoder_need(const CodecShape& shape);
void make_row_decoder(const CodecShape& shape, Arena* arena, RowDecoder** decoder);
void restart_row_decoder(RowDecoder* decoder);
// Decodes a chunk. Must be called for every chunk of the connection in the order sent, wanted or not. True: the rows
// are in the decoder's picture. False: no encoder wrote these bytes; the picture may be corrupt and the decoder is
// unusable until restarted: end the connection.
[[nodiscard]] bool decode_rows(RowDecoder* decoder, const RowChunk& chunk);

// Whether no channel of any pixel differs by more levels than the tolerance.
bool pixels_close(WireFormat format, const std::uint8_t* a, const std::uint8_t* b, std::uint32_t pixel_count,
                  std::uint32_t tolerance);

// First byte of a row in the picture.
inline std::uint8_t* picture_row(const CodecState& s, std::uint32_t row) {
  return s.versions.data +
         (std::size_t(s.current[row]) * s.shape.height + row) * s.shape.width * pixel_bytes(s.shape.format);
}

}  // namespace pocketray
