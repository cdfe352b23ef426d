#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "wire/codec_state.h"
#include "wire/entropy.h"
#include "wire/pixel_runs.h"
#include "wire/predict.h"

namespace pocketray {
namespace {

// From zlib.h: the tables follow from windowBits and memLevel; the rest is zlib's structure, measured by
// tests/wire/codec_test.cpp.
constexpr std::size_t kDeflateBytes = (1u << (15 + 2)) + (1u << (kMemoryLevel + 9)) + (12u << 10);
constexpr std::uint32_t kRawBytesMax = 8;  // deflation does not shrink so few bytes

// Writes the runs of pixels that differ from the picture, or whose row has not been sent; returns the end.
template <class Pixel>
std::uint8_t* find_runs(const std::uint8_t* pixels, const std::uint8_t* before, const std::uint8_t* sent,
                        std::uint32_t width, std::uint32_t row_count, std::uint8_t* runs) {
  const bool all_sent = std::all_of(sent, sent + row_count, [](std::uint8_t row) { return row != 0; });
  const std::uint32_t pixel_count = width * row_count;
  auto changed = [&](std::uint32_t i) {
    if (Pixel::load(pixels + i * Pixel::kBytes) != Pixel::load(before + i * Pixel::kBytes)) return true;
    return !all_sent && !sent[i / width];
  };
  std::uint32_t given = 0;  // end of the last run
  for (std::uint32_t i = 0; i < pixel_count; ++i) {
    if (!changed(i)) continue;
    std::uint32_t end = i + 1;
    for (std::uint32_t k = end; k < pixel_count && k - end < kGapMin; ++k)
      if (changed(k)) end = k + 1;
    runs = put_number(runs, i - given);
    runs = put_number(runs, end - i);
    given = end, i = end - 1;
  }
  return runs;
}

// Calls visit(index, column) for every pixel of the runs.
template <class Visit>
void for_each_given(std::uint32_t width, const std::uint8_t* runs, const std::uint8_t* runs_end, Visit visit) {
  std::uint32_t at = 0;
  while (runs < runs_end) {
    std::uint32_t skip, give;
    runs = get_number(runs, runs_end, &skip);
    runs = get_number(runs, runs_end, &give);
    at += skip;
    std::uint32_t column = at % width;
    for (std::uint32_t end = at + give; at < end; ++at) {
      visit(at, column);
      if (++column == width) column = 0;
    }
  }
}

// Estimated size of deflated pixels, in bits: pixels that repeat their neighbours take little, the others their
// entropy.
struct Estimate {
  ByteCounts literals;
  std::uint32_t repeat_count = 0;
  std::uint64_t bits() const { return entropy_bits(literals) + std::uint64_t(repeat_count) * 5 / 16; }
};

// Deflation finds more redundancy in unpredicted pixels than the estimate sees, so differences must be smaller by this
// factor. Measured by tests/wire/codec_frames_test.cpp.
constexpr std::uint64_t kPlainBonus = 5, kPlainBonusOf = 4;

struct Choice {
  bool predict, deflate;
};

template <class Pixel>
Choice choose_encoding(const std::uint8_t* pixels, std::uint32_t width, const std::uint8_t* runs,
                       const std::uint8_t* runs_end) {
  Estimate plain, predicted;
  std::uint64_t given_bits = 0;
  std::uint32_t difference_before = 0;
  for_each_given(width, runs, runs_end, [&](std::uint32_t at, std::uint32_t column) {
    const std::uint8_t* here = pixels + at * Pixel::kBytes;
    std::uint32_t pixel = Pixel::load(here), left = column > 0 ? Pixel::load(here - Pixel::kBytes) : 0;
    bool repeats = column > 0 && left == pixel;
    if (column > 0 && at >= width) {
      const std::uint8_t* above = here - width * Pixel::kBytes;
      repeats = repeats || (Pixel::load(above) == pixel && Pixel::load(above - Pixel::kBytes) == left);
    }
    repeats ? void(++plain.repeat_count) : count_bytes(&plain.literals, pixel, Pixel::kBytes);
    std::uint32_t difference = difference_of<Pixel>(pixel, predict<Pixel>(pixels, at, column, width));
    if (given_bits > 0 && difference == difference_before)
      ++predicted.repeat_count;
    else
      count_bytes(&predicted.literals, difference, Pixel::kBytes);
    difference_before = difference;
    given_bits += 8 * Pixel::kBytes;
  });
  Choice choice;
  choice.predict = predicted.bits() * kPlainBonus < plain.bits() * kPlainBonusOf;
  // Bytes of equal frequency are noise: saving a 32nd is not worth either end's time.
  std::uint64_t bits = choice.predict ? predicted.bits() : plain.bits();
  choice.deflate = given_bits > 8 * kRawBytesMax && bits < given_bits - given_bits / 32;
  return choice;
}

struct Body {
  std::uint32_t byte_count;
  Choice choice;
};

template <class Pixel>
Body make_body(CodecState* s, const std::uint8_t* pixels, const std::uint8_t* before, const std::uint8_t* sent,
               std::uint32_t row_count) {
  std::uint32_t width = s->shape.width;
  std::uint8_t* runs = s->runs.data;
  std::uint8_t* runs_end = find_runs<Pixel>(pixels, before, sent, width, row_count, runs);
  CHECK_LE(static_cast<std::size_t>(runs_end - runs), s->runs.count);
  Choice choice = choose_encoding<Pixel>(pixels, width, runs, runs_end);
  std::uint8_t* at = put_number(s->body.data, static_cast<std::uint32_t>(runs_end - runs));
  std::memcpy(at, runs, static_cast<std::size_t>(runs_end - runs));
  at += runs_end - runs;
  for_each_given(width, runs, runs_end, [&](std::uint32_t index, std::uint32_t column) {
    std::uint32_t pixel = Pixel::load(pixels + index * Pixel::kBytes);
    if (choice.predict) pixel = difference_of<Pixel>(pixel, predict<Pixel>(pixels, index, column, width));
    Pixel::store(at, pixel);
    at += Pixel::kBytes;
  });
  CHECK_LE(static_cast<std::size_t>(at - s->body.data), s->body.count);
  return {static_cast<std::uint32_t>(at - s->body.data), choice};
}

std::uint32_t deflate_body(CodecState* s, std::uint32_t body_bytes, int level, std::uint8_t* bytes,
                           std::uint32_t capacity) {
  z_stream* z = &s->stream;
  CHECK_LE(body_bytes, s->body.count);
  z->next_in = s->body.data, z->avail_in = 0;
  z->next_out = bytes, z->avail_out = capacity;
  if (level != s->level) {
    CHECK_EQ(deflateParams(z, level, Z_DEFAULT_STRATEGY), Z_OK);
    s->level = level;
  }
  z->avail_in = body_bytes;
  CHECK_EQ(deflate(z, Z_SYNC_FLUSH), Z_OK);
  CHECK_EQ(z->avail_in, 0u);
  CHECK_GT(z->avail_out, 0u);
  // A flush ends in 00 00 FF FF, which the receiver restores [RFC 7692, sec. 7.2.1].
  std::uint32_t byte_count = capacity - z->avail_out;
  CHECK_GT(byte_count, 4u);
  return byte_count - 4;
}

}  // namespace

std::size_t row_encoder_need(const CodecShape& shape) {
  return arena_need(sizeof(RowEncoder)) + codec_state_need(shape, kDeflateBytes);
}

Status make_row_encoder(const CodecShape& shape, Arena* arena, RowEncoder** encoder) {
  CHECK(arena != nullptr && encoder != nullptr);
  *encoder = arena_array<RowEncoder>(arena, 1).data;
  CodecState* s = &(*encoder)->state;
  make_codec_state(shape, kDeflateBytes, arena, s);
  s->level = 1;
  if (deflateInit2(&s->stream, s->level, Z_DEFLATED, kWindowBits, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK)
    return failure("this zlib (%s) needs more than %zu bytes to compress: use the original zlib", zlibVersion(),
                   kDeflateBytes);
  return success();
}

void restart_row_encoder(RowEncoder* encoder) {
  restart_codec_state(&encoder->state);
  CHECK_EQ(deflateReset(&encoder->state.stream), Z_OK);
}

std::uint32_t encode_rows(RowEncoder* encoder, std::uint32_t row_begin, std::uint32_t row_count,
                          const std::uint8_t* pixels, int level, std::uint8_t* bytes, std::uint8_t* encoding) {
  CodecState* s = &encoder->state;
  CHECK(pixels != nullptr && bytes != nullptr && encoding != nullptr);
  CHECK_GT(row_count, 0u);
  CHECK_LE(row_count, s->shape.chunk_rows_max);
  CHECK_LE(row_begin, s->shape.height - row_count);
  CHECK(level >= 0 && level <= 9);
  std::uint8_t* before = picture_row(*s, row_begin);
  std::uint8_t* sent = s->sent.data + row_begin;
  Body body = s->shape.format == WireFormat::rgb565 ? make_body<Pixel565>(s, pixels, before, sent, row_count)
                                                    : make_body<Pixel888>(s, pixels, before, sent, row_count);
  std::memset(sent, 1, row_count);
  std::memcpy(before, pixels, std::size_t(row_count) * s->shape.width * pixel_bytes(s->shape.format));
  *encoding = body.choice.predict ? kEncodingPredicted : 0;
  if (level == 0 || !body.choice.deflate) {
    std::memcpy(bytes, s->body.data, body.byte_count);
    return body.byte_count;
  }
  *encoding |= kEncodingDeflated;
  return deflate_body(s, body.byte_count, level, bytes, encoded_bytes_max(s->shape, row_count));
}

}  // namespace pocketray
