#include "present/png_stream.h"

#include <zlib.h>

#include <cstdlib>
#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

// zlib's window and memory level, chosen for devices: 2^(kWindowBits + 2) + 2^(kMemoryLevel + 9) bytes (zlib.h) instead
// of 256 KiB.
constexpr int kWindowBits = 13, kMemoryLevel = 7;
constexpr std::size_t kDeflateBytes = (1u << (kWindowBits + 2)) + (1u << (kMemoryLevel + 9));
constexpr std::size_t kChunkBytes = 8192;  // of compressed data
constexpr std::size_t kNumberBytes = 4;    // of the sequence number before it, in an animation
constexpr int kPixelBytes = 3;

// Predictor of [PNG 3rd edition, sec. 9.4].
int paeth(int left, int above, int above_left) {
  int estimate = left + above - above_left;
  int to_left = std::abs(estimate - left), to_above = std::abs(estimate - above),
      to_above_left = std::abs(estimate - above_left);
  if (to_left <= to_above && to_left <= to_above_left) return left;
  return to_above <= to_above_left ? above : above_left;
}

// Writes a row as differences from its Paeth estimates, after the filter's number. `above`: the previous row, or null.
void filter_row(const std::uint8_t* row, const std::uint8_t* above, std::size_t count, std::uint8_t* filtered) {
  constexpr std::uint8_t kPaeth = 4;
  *filtered++ = kPaeth;
  for (std::size_t i = 0; i < count; ++i) {
    bool first = i < kPixelBytes;
    int left = first ? 0 : row[i - kPixelBytes], up = above ? above[i] : 0;
    int up_left = first || !above ? 0 : above[i - kPixelBytes];
    filtered[i] = static_cast<std::uint8_t>(row[i] - paeth(left, up, up_left));
  }
}

voidpf take(voidpf arena, uInt count, uInt bytes) {
  return arena_try_allocate(static_cast<Arena*>(arena), static_cast<std::size_t>(count) * bytes);
}
void give_back(voidpf, voidpf) {}  // the arena's mark frees everything at once

struct PngEncoder {
  ByteSink sink;
  z_stream stream;
  std::uint8_t* chunk;  // room for a number, then compressed data
  std::uint32_t* sequence;
};

void write_data(PngEncoder* e, std::size_t count) {
  if (!e->sequence) return write_png_chunk(e->sink, "IDAT", e->chunk + kNumberBytes, count);
  put_big_endian((*e->sequence)++, e->chunk);
  write_png_chunk(e->sink, "fdAT", e->chunk, kNumberBytes + count);
}

// Compresses the stream's input, with Z_FINISH all that is left, and writes each chunk that fills up.
void compress(PngEncoder* e, int flush) {
  int result = Z_OK;
  do {
    result = deflate(&e->stream, flush);
    CHECK_GE(result == Z_BUF_ERROR ? Z_OK : result, Z_OK);
    std::size_t count = kChunkBytes - e->stream.avail_out;
    if (e->stream.avail_out > 0 && result != Z_STREAM_END) return;
    if (count > 0) write_data(e, count);
    e->stream.next_out = e->chunk + kNumberBytes, e->stream.avail_out = kChunkBytes;
  } while (flush == Z_FINISH ? result != Z_STREAM_END : e->stream.avail_in > 0);
}

void encode_rows(PngEncoder* e, const std::uint8_t* first, std::size_t line_bytes, const PixelBox& box,
                 std::uint8_t* filtered) {
  const std::size_t row_bytes = kPixelBytes * static_cast<std::size_t>(box.width);
  e->stream.next_out = e->chunk + kNumberBytes, e->stream.avail_out = kChunkBytes;
  for (int y = 0; y < box.height; ++y) {
    const std::uint8_t* row = first + static_cast<std::size_t>(y) * line_bytes;
    filter_row(row, y > 0 ? row - line_bytes : nullptr, row_bytes, filtered);
    e->stream.next_in = filtered, e->stream.avail_in = static_cast<uInt>(row_bytes + 1);
    compress(e, Z_NO_FLUSH);
  }
  compress(e, Z_FINISH);
}

}  // namespace

void put_big_endian(std::uint32_t value, std::uint8_t* bytes) {
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

void write_png_chunk(const ByteSink& sink, const char* type, const std::uint8_t* data, std::size_t count) {
  std::uint8_t head[8], tail[4];
  put_big_endian(static_cast<std::uint32_t>(count), head);
  std::memcpy(head + 4, type, 4);
  uLong crc = crc32(crc32(0, nullptr, 0), head + 4, 4);
  if (count > 0) crc = crc32(crc, data, static_cast<uInt>(count));
  put_big_endian(static_cast<std::uint32_t>(crc), tail);
  sink.write(sink.user, head, sizeof head);
  if (count > 0) sink.write(sink.user, data, count);
  sink.write(sink.user, tail, sizeof tail);
}

void write_png_head(const ByteSink& sink, int width, int height) {
  CHECK(width > 0 && height > 0);
  static const std::uint8_t kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  sink.write(sink.user, kSignature, sizeof kSignature);
  std::uint8_t header[13] = {0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0};  // 8 bits, RGB, not interlaced
  put_big_endian(static_cast<std::uint32_t>(width), header);
  put_big_endian(static_cast<std::uint32_t>(height), header + 4);
  write_png_chunk(sink, "IHDR", header, sizeof header);
  const std::uint8_t perceptual = 0;
  write_png_chunk(sink, "sRGB", &perceptual, 1);
}

std::size_t png_pixels_need(int width) {
  constexpr std::size_t kStructures = 16 << 10;  // zlib besides its tables; measured by image_file_test.cpp
  return kDeflateBytes + kStructures + arena_need(kNumberBytes + kChunkBytes) +
         arena_need(kPixelBytes * static_cast<std::size_t>(width) + 1);
}

Status write_png_pixels(const ByteSink& sink, const std::uint8_t* rgb, std::size_t row_bytes, const PixelBox& box,
                        std::uint32_t* sequence, Arena* arena) {
  CHECK(rgb != nullptr && arena != nullptr && sink.write != nullptr);
  CHECK(box.left >= 0 && box.top >= 0 && box.width > 0 && box.height > 0);
  CHECK_LE(kPixelBytes * static_cast<std::size_t>(box.left + box.width), row_bytes);
  std::size_t mark = arena_mark(*arena);
  PngEncoder encoder = {sink, {}, nullptr, sequence};
  encoder.stream.zalloc = take, encoder.stream.zfree = give_back, encoder.stream.opaque = arena;
  encoder.chunk = static_cast<std::uint8_t*>(arena_try_allocate(arena, kNumberBytes + kChunkBytes));
  void* filtered = arena_try_allocate(arena, kPixelBytes * static_cast<std::size_t>(box.width) + 1);
  bool fits =
      encoder.chunk && filtered &&
      deflateInit2(&encoder.stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kWindowBits, kMemoryLevel, Z_FILTERED) == Z_OK;
  if (fits) {
    const std::uint8_t* first =
        rgb + static_cast<std::size_t>(box.top) * row_bytes + kPixelBytes * static_cast<std::size_t>(box.left);
    encode_rows(&encoder, first, row_bytes, box, static_cast<std::uint8_t*>(filtered));
    deflateEnd(&encoder.stream);
  }
  arena_release(arena, mark);
  if (fits) return success();
  return failure("cannot write a PNG: it needs %zu bytes of memory, %zu are free in the %s arena",
                 png_pixels_need(box.width), arena_free(*arena), arena->name);
}

}  // namespace pocketray
