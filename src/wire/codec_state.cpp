// State common to both ends of the codec: memory and zlib's allocator.
#include "wire/codec_state.h"

#include <cstring>

#include "base/check.h"
#include "base/limits.h"
#include "wire/pixel_runs.h"

namespace pocketray {
namespace {

void* take(void* arena, uInt count, uInt bytes) {
  std::uint64_t total = std::uint64_t(count) * bytes;
  return total <= SIZE_MAX ? arena_try_allocate(static_cast<Arena*>(arena), static_cast<std::size_t>(total)) : nullptr;
}
void give_back(void*, void*) {}  // the arena frees everything at once

std::uint32_t chunk_pixels(const CodecShape& shape, std::uint32_t row_count) { return shape.width * row_count; }

std::size_t picture_bytes(const CodecShape& shape) {
  return std::size_t(shape.width) * shape.height * pixel_bytes(shape.format);
}

}  // namespace

std::uint32_t body_bytes_max(const CodecShape& shape, std::uint32_t row_count) {
  std::uint32_t pixels = chunk_pixels(shape, row_count);
  return kNumberBytesMax + run_bytes_max(pixels) + pixels * pixel_bytes(shape.format);
}

// Incompressible data is stored: less than an eighth more with any of zlib's settings, and a few bytes to flush.
std::uint32_t encoded_bytes_max(const CodecShape& shape, std::uint32_t row_count) {
  std::uint32_t body = body_bytes_max(shape, row_count);
  return body + body / 8 + 64;
}

std::size_t codec_state_need(const CodecShape& shape, std::size_t zlib_bytes) {
  // One byte more than a body may have, to detect bodies that are too long.
  return arena_need(picture_bytes(shape)) + arena_need<std::uint8_t>(shape.height) +
         arena_need(run_bytes_max(chunk_pixels(shape, shape.chunk_rows_max))) +
         arena_need(body_bytes_max(shape, shape.chunk_rows_max) + 1) + arena_need(zlib_bytes);
}

bool codec_shape_valid(const CodecShape& shape) {
  return shape.width >= 1 && shape.width <= kImageSideMax && shape.height >= 1 && shape.height <= kImageSideMax &&
         shape.chunk_rows_max >= 1 && shape.chunk_rows_max <= shape.height &&
         shape.chunk_rows_max <= kChunkPixelsMax / shape.width &&
         encoded_bytes_max(shape, shape.chunk_rows_max) <= kChunkBytesMax;
}

void make_codec_state(const CodecShape& shape, std::size_t zlib_bytes, Arena* arena, CodecState* state) {
  CHECK(codec_shape_valid(shape));
  std::size_t used = arena->used;
  *state = CodecState();
  state->shape = shape;
  state->picture = arena_array<std::uint8_t>(arena, picture_bytes(shape));
  state->sent = arena_array<std::uint8_t>(arena, shape.height);
  state->runs = arena_array<std::uint8_t>(arena, run_bytes_max(chunk_pixels(shape, shape.chunk_rows_max)));
  state->body = arena_array<std::uint8_t>(arena, body_bytes_max(shape, shape.chunk_rows_max) + 1);
  state->zlib_arena = make_arena("zlib", arena_allocate(arena, zlib_bytes), arena_need(zlib_bytes));
  CHECK_EQ(arena->used - used, codec_state_need(shape, zlib_bytes));
  state->stream.zalloc = take, state->stream.zfree = give_back, state->stream.opaque = &state->zlib_arena;
  restart_codec_state(state);
}

void restart_codec_state(CodecState* state) {
  CHECK(state->picture.data != nullptr);
  std::memset(state->picture.data, 0, state->picture.bytes());
  std::memset(state->sent.data, 0, state->sent.bytes());
  state->broken = false;
}

}  // namespace pocketray
