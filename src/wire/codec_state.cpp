#include "wire/codec_state.h"

#include <cstring>

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {
namespace {

std::size_t row_bytes(const CodecShape& shape) { return std::size_t(shape.width) * pixel_bytes(shape.format); }
std::size_t versions_bytes(const CodecShape& shape) { return (2 * std::size_t(shape.height) + 1) * row_bytes(shape); }
std::uint32_t block_columns(const CodecShape& shape) { return (shape.width + kBlockColumns - 1) / kBlockColumns; }

}  // namespace

std::uint32_t raw_bytes(const CodecShape& shape, std::uint32_t row_count) {
  CHECK_LE(row_count, shape.height);
  return static_cast<std::uint32_t>(row_bytes(shape) * row_count);
}

// A chunk that coding would lengthen is sent raw.
std::uint32_t encoded_bytes_max(const CodecShape& shape, std::uint32_t row_count) {
  return raw_bytes(shape, row_count);
}

std::size_t codec_state_need(const CodecShape& shape) {
  return arena_need(versions_bytes(shape)) + arena_need<std::uint8_t>(shape.height) +
         arena_need<std::uint32_t>(shape.height) + arena_need<BlockChoice>(block_columns(shape)) +
         arena_need<std::uint8_t>(shape.width + 2);
}

bool codec_shape_valid(const CodecShape& shape) {
  return shape.width >= 1 && shape.width <= kImageSideMax && shape.height >= 1 && shape.height <= kImageSideMax &&
         shape.chunk_rows_max >= 1 && shape.chunk_rows_max <= shape.height &&
         shape.chunk_rows_max <= kChunkPixelsMax / shape.width &&
         encoded_bytes_max(shape, shape.chunk_rows_max) <= kChunkBytesMax;
}

void make_codec_state(const CodecShape& shape, Arena* arena, CodecState* state) {
  CHECK(arena != nullptr && state != nullptr);
  CHECK(codec_shape_valid(shape));
  std::size_t used = arena->used;
  *state = CodecState();
  state->shape = shape;
  state->versions = arena_array<std::uint8_t>(arena, versions_bytes(shape));
  state->current = arena_array<std::uint8_t>(arena, shape.height);
  state->row_frames = arena_array<std::uint32_t>(arena, shape.height);
  state->blocks = arena_array<BlockChoice>(arena, block_columns(shape));
  state->differs = arena_array<std::uint8_t>(arena, shape.width + 2);
  CHECK_EQ(arena->used - used, codec_state_need(shape));
  restart_codec_state(state);
}

void restart_codec_state(CodecState* state) {
  CHECK(state->versions.data != nullptr);
  std::memset(state->versions.data, 0, state->versions.bytes());
  std::memset(state->current.data, 0, state->current.bytes());
  std::memset(state->row_frames.data, 0, state->row_frames.bytes());
  state->frame = 0;
  for (BlockChoice& block : state->blocks) block = {};
  restart_models(&state->models);
  state->broken = false;
}

void begin_rows(CodecState* state, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count) {
  CHECK_GT(row_count, 0u);
  CHECK_LE(row_count, state->shape.height);
  CHECK_LE(row_begin, state->shape.height - row_count);
  state->frame = frame;
  for (std::uint32_t row = row_begin; row < row_begin + row_count; ++row) {
    state->current[row] ^= 1u;
    state->row_frames[row] = frame;
  }
}

void put_raw_rows(CodecState* state, std::uint32_t row_begin, std::uint32_t row_count, const std::uint8_t* pixels) {
  CHECK(pixels != nullptr);
  CHECK_LE(row_count, state->shape.height);
  CHECK_LE(row_begin, state->shape.height - row_count);
  const std::size_t stride = row_bytes(state->shape);
  for (std::uint32_t i = 0; i < row_count; ++i)
    std::memcpy(picture_row(*state, row_begin + i), pixels + i * stride, stride);
  for (BlockChoice& block : state->blocks) block = {};  // an encoder may have tried to code the rows
}

bool pixels_close(WireFormat format, const std::uint8_t* a, const std::uint8_t* b, std::uint32_t pixel_count,
                  std::uint32_t tolerance) {
  const std::uint32_t bytes = pixel_bytes(format);
  if (std::memcmp(a, b, std::size_t(pixel_count) * bytes) == 0) return true;
  if (tolerance == 0) return false;
  for (const std::uint8_t* end = a + std::size_t(pixel_count) * bytes; a < end; a += bytes, b += bytes)
    if (!(format == WireFormat::rgb565 ? is_close<Pixel565>(Pixel565::load(a), Pixel565::load(b), tolerance)
                                       : is_close<Pixel888>(Pixel888::load(a), Pixel888::load(b), tolerance)))
      return false;
  return true;
}

}  // namespace pocketray
