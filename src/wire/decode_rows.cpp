#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "wire/codec_state.h"
#include "wire/pixel_runs.h"
#include "wire/predict.h"

namespace pocketray {
namespace {

// From zlib.h: the window, plus zlib's structure, measured by tests/wire/codec_test.cpp.
constexpr std::size_t kInflateBytes = (1u << 15) + (12u << 10);

// Inflates the body into s->body; returns its size, or 0 if the stream is invalid or the body too long.
std::uint32_t inflate_body(CodecState* s, const RowChunk& chunk) {
  static constexpr std::uint8_t kFlushEnd[4] = {0x00, 0x00, 0xFF, 0xFF};  // omitted by the sender
  z_stream* z = &s->stream;
  std::uint32_t capacity = body_bytes_max(s->shape, chunk.row_count) + 1;
  CHECK_LE(capacity, s->body.count);
  z->next_out = s->body.data, z->avail_out = capacity;
  z->next_in = const_cast<Bytef*>(chunk.bytes.data), z->avail_in = chunk.bytes.count;
  if (inflate(z, Z_SYNC_FLUSH) != Z_OK || z->avail_in != 0 || z->avail_out == 0) return 0;
  z->next_in = const_cast<Bytef*>(kFlushEnd), z->avail_in = sizeof kFlushEnd;
  if (inflate(z, Z_SYNC_FLUSH) != Z_OK || z->avail_in != 0 || z->avail_out == 0) return 0;
  CHECK_LE(z->avail_out, capacity);
  return capacity - z->avail_out;
}

// Whether all pixels [begin, end) may be left as they are: their rows were sent before.
bool may_leave(const std::uint8_t* sent, std::uint32_t width, std::uint32_t begin, std::uint32_t end) {
  return begin == end ||
         std::all_of(sent + begin / width, sent + (end - 1) / width + 1, [](std::uint8_t row) { return row != 0; });
}

// Writes the values to the pixels of the runs. False if runs or values do not fit, or pixels of new rows are missing.
template <class Pixel>
bool apply_body(const std::uint8_t* body, std::uint32_t byte_count, bool predicted, std::uint32_t width,
                std::uint32_t pixel_count, const std::uint8_t* sent, std::uint8_t* pixels) {
  const std::uint8_t* end = body + byte_count;
  std::uint32_t run_bytes;
  const std::uint8_t* runs = get_number(body, end, &run_bytes);
  if (!runs || run_bytes > static_cast<std::size_t>(end - runs)) return false;
  const std::uint8_t* runs_end = runs + run_bytes;
  const std::uint8_t* values = runs_end;
  std::uint32_t at = 0;
  while (runs < runs_end) {
    std::uint32_t skip, give;
    if (!(runs = get_number(runs, runs_end, &skip)) || !(runs = get_number(runs, runs_end, &give))) return false;
    if (skip > pixel_count - at || give > pixel_count - at - skip || give == 0) return false;
    if (give > static_cast<std::size_t>(end - values) / Pixel::kBytes) return false;
    if (!may_leave(sent, width, at, at + skip)) return false;
    at += skip;
    std::uint32_t column = at % width;
    for (std::uint32_t run_end = at + give; at < run_end; ++at, values += Pixel::kBytes) {
      std::uint32_t pixel = Pixel::load(values);
      if (predicted) pixel = pixel_of<Pixel>(pixel, predict<Pixel>(pixels, at, column, width));
      Pixel::store(pixels + at * Pixel::kBytes, pixel);
      if (++column == width) column = 0;
    }
  }
  return values == end && may_leave(sent, width, at, pixel_count);
}

bool decode_chunk(CodecState* s, const RowChunk& chunk) {
  if (chunk.row_count == 0 || chunk.row_count > s->shape.chunk_rows_max ||
      chunk.row_begin > s->shape.height - chunk.row_count)
    return false;
  if ((chunk.encoding & ~(kEncodingPredicted | kEncodingDeflated)) != 0) return false;
  const std::uint8_t* body = chunk.bytes.data;
  std::uint32_t byte_count = chunk.bytes.count;
  if (chunk.encoding & kEncodingDeflated) {
    body = s->body.data;
    byte_count = inflate_body(s, chunk);
  }
  if (byte_count == 0) return false;
  bool predicted = (chunk.encoding & kEncodingPredicted) != 0;
  std::uint32_t width = s->shape.width, pixel_count = width * chunk.row_count;
  CHECK_LE(std::uint64_t(chunk.row_begin) * width + pixel_count, std::uint64_t(s->shape.height) * width);
  std::uint8_t* pixels = picture_row(*s, chunk.row_begin);
  std::uint8_t* sent = s->sent.data + chunk.row_begin;
  if (!(s->shape.format == WireFormat::rgb565
            ? apply_body<Pixel565>(body, byte_count, predicted, width, pixel_count, sent, pixels)
            : apply_body<Pixel888>(body, byte_count, predicted, width, pixel_count, sent, pixels)))
    return false;
  std::memset(sent, 1, chunk.row_count);
  return true;
}

}  // namespace

std::size_t row_decoder_need(const CodecShape& shape) {
  return arena_need(sizeof(RowDecoder)) + codec_state_need(shape, kInflateBytes);
}

Status make_row_decoder(const CodecShape& shape, Arena* arena, RowDecoder** decoder) {
  CHECK(arena != nullptr && decoder != nullptr);
  *decoder = arena_array<RowDecoder>(arena, 1).data;
  CodecState* s = &(*decoder)->state;
  make_codec_state(shape, kInflateBytes, arena, s);
  if (inflateInit2(&s->stream, kWindowBits) != Z_OK)
    return failure("this zlib (%s) needs more than %zu bytes to decompress: use the original zlib", zlibVersion(),
                   kInflateBytes);
  return success();
}

void restart_row_decoder(RowDecoder* decoder) {
  restart_codec_state(&decoder->state);
  CHECK_EQ(inflateReset(&decoder->state.stream), Z_OK);
}

bool decode_rows(RowDecoder* decoder, const RowChunk& chunk) {
  if (decoder->state.broken) return false;
  decoder->state.broken = !decode_chunk(&decoder->state, chunk);
  return !decoder->state.broken;
}

}  // namespace pocketray
