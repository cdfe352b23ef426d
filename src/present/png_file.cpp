#include "present/png_file.h"

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
constexpr int kPixelBytes = 3;

void put_big_endian(std::uint32_t value, std::uint8_t* bytes) {
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
}

// [PNG 3rd edition, sec. 5.3]: length, type, data, and the CRC of type and data.
void write_chunk(const ByteSink& sink, const char* type, const std::uint8_t* data, std::size_t count) {
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

// [PNG 3rd edition, sec. 9.4].
int paeth(int left, int above, int above_left) {
  int estimate = left + above - above_left;
  int to_left = std::abs(estimate - left), to_above = std::abs(estimate - above),
      to_above_left = std::abs(estimate - above_left);
  if (to_left <= to_above && to_left <= to_above_left) return left;
  return to_above <= to_above_left ? above : above_left;
}

// A row as differences from its Paeth estimates, behind the filter's number. `above`: the row before, or null.
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

struct Encoder {
  ByteSink sink;
  z_stream stream;
  std::uint8_t* chunk;
};

// Compresses the stream's input, and with Z_FINISH all that is left, writing each chunk that fills.
void compress(Encoder* e, int flush) {
  int result = Z_OK;
  do {
    result = deflate(&e->stream, flush);
    CHECK_GE(result == Z_BUF_ERROR ? Z_OK : result, Z_OK);
    std::size_t count = kChunkBytes - e->stream.avail_out;
    if (e->stream.avail_out > 0 && result != Z_STREAM_END) return;
    if (count > 0) write_chunk(e->sink, "IDAT", e->chunk, count);
    e->stream.next_out = e->chunk, e->stream.avail_out = kChunkBytes;
  } while (flush == Z_FINISH ? result != Z_STREAM_END : e->stream.avail_in > 0);
}

void encode(Encoder* e, const std::uint8_t* rgb, int width, int height, std::uint8_t* filtered) {
  const std::size_t row_bytes = kPixelBytes * static_cast<std::size_t>(width);
  static const std::uint8_t kSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  e->sink.write(e->sink.user, kSignature, sizeof kSignature);
  std::uint8_t header[13] = {0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0};  // 8 bits, RGB, not interlaced
  put_big_endian(static_cast<std::uint32_t>(width), header);
  put_big_endian(static_cast<std::uint32_t>(height), header + 4);
  write_chunk(e->sink, "IHDR", header, sizeof header);
  const std::uint8_t perceptual = 0;
  write_chunk(e->sink, "sRGB", &perceptual, 1);
  e->stream.next_out = e->chunk, e->stream.avail_out = kChunkBytes;
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = rgb + static_cast<std::size_t>(y) * row_bytes;
    filter_row(row, y > 0 ? row - row_bytes : nullptr, row_bytes, filtered);
    e->stream.next_in = filtered, e->stream.avail_in = static_cast<uInt>(row_bytes + 1);
    compress(e, Z_NO_FLUSH);
  }
  compress(e, Z_FINISH);
  write_chunk(e->sink, "IEND", nullptr, 0);
}

}  // namespace

std::size_t encode_png_need(int width) {
  constexpr std::size_t kStructures = 16 << 10;  // zlib's besides its tables; measured by image_file_test.cpp
  return kDeflateBytes + kStructures + arena_need(kChunkBytes) +
         arena_need(kPixelBytes * static_cast<std::size_t>(width) + 1);
}

Status encode_png(const std::uint8_t* rgb, int width, int height, Arena* arena, const ByteSink& sink) {
  CHECK(rgb != nullptr && arena != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0);
  std::size_t mark = arena_mark(*arena);
  Encoder encoder = {sink, {}, nullptr};
  encoder.stream.zalloc = take, encoder.stream.zfree = give_back, encoder.stream.opaque = arena;
  encoder.chunk = static_cast<std::uint8_t*>(arena_try_allocate(arena, kChunkBytes));
  void* filtered = arena_try_allocate(arena, kPixelBytes * static_cast<std::size_t>(width) + 1);
  bool fits =
      encoder.chunk && filtered &&
      deflateInit2(&encoder.stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kWindowBits, kMemoryLevel, Z_FILTERED) == Z_OK;
  if (fits) {
    encode(&encoder, rgb, width, height, static_cast<std::uint8_t*>(filtered));
    deflateEnd(&encoder.stream);
  }
  arena_release(arena, mark);
  if (fits) return success();
  return failure("cannot write a PNG: it needs %zu bytes of memory, %zu are free in the %s arena",
                 encode_png_need(width), arena_free(*arena), arena->name);
}

}  // namespace pocketray
