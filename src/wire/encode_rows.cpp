#include <cstring>

#include "base/check.h"
#include "wire/motion_search.h"

namespace pocketray {
namespace {

// Returns whether the rows are unchanged since they were last sent.
bool is_unchanged(const CodecState& s, std::uint32_t row_begin, std::uint32_t row_count, const std::uint8_t* pixels) {
  const std::size_t stride = raw_bytes(s.shape, 1);
  for (std::uint32_t i = 0; i < row_count; ++i)
    if (std::memcmp(pixels + i * stride, picture_row(s, row_begin + i), stride) != 0) return false;
  return true;
}

// Returns the length of the code, or `capacity` if the code does not fit.
template <class Pixel>
std::size_t code_rows(CodecState* s, std::uint32_t row_begin, std::uint32_t row_count, const std::uint8_t* pixels,
                      std::uint32_t tolerance, std::uint8_t* bytes, std::size_t capacity) {
  RangeEncoder coder(bytes, capacity);
  const MotionSearch search = {s, pixels, row_begin, tolerance};
  auto choose = [&](const Block& block, const BlockChoice& beside, const BlockChoice& below, BlockChoice* choice) {
    choose_block<Pixel>(search, block, beside, below, choice);
  };
  CHECK(code_blocks<Pixel>(&coder, s, row_begin, row_begin + row_count, pixels, tolerance, choose));
  const std::size_t byte_count = coder.finish();
  return coder.overflows() ? capacity : byte_count;
}

}  // namespace

std::size_t row_encoder_need(const CodecShape& shape) {
  return arena_need(sizeof(RowEncoder)) + codec_state_need(shape);
}

void make_row_encoder(const CodecShape& shape, Arena* arena, RowEncoder** encoder) {
  CHECK(arena != nullptr && encoder != nullptr);
  *encoder = arena_array<RowEncoder>(arena, 1).data;
  make_codec_state(shape, arena, &(*encoder)->state);
}

void restart_row_encoder(RowEncoder* encoder) {
  CHECK(encoder != nullptr);
  restart_codec_state(&encoder->state);
}

std::uint32_t encode_rows(RowEncoder* encoder, std::uint32_t frame, std::uint32_t row_begin, std::uint32_t row_count,
                          const std::uint8_t* pixels, RowCoding coding, std::uint8_t* bytes, std::uint8_t* encoding) {
  CodecState* s = &encoder->state;
  CHECK(coding <= RowCoding::near_lossless);
  CHECK(pixels != nullptr && bytes != nullptr && encoding != nullptr);
  CHECK_GT(row_count, 0u);
  CHECK_LE(row_count, s->shape.chunk_rows_max);
  CHECK_LE(row_begin, s->shape.height - row_count);
  const bool coded = coding != RowCoding::raw || is_unchanged(*s, row_begin, row_count, pixels);
  const std::uint32_t raw = raw_bytes(s->shape, row_count), tolerance = coding == RowCoding::near_lossless ? 1 : 0;
  begin_rows(s, frame, row_begin, row_count);
  if (coded) {
    const CodeModels models = s->models;
    const std::size_t byte_count = s->shape.format == WireFormat::rgb565
                                       ? code_rows<Pixel565>(s, row_begin, row_count, pixels, tolerance, bytes, raw)
                                       : code_rows<Pixel888>(s, row_begin, row_count, pixels, tolerance, bytes, raw);
    CHECK_LE(byte_count, raw);
    *encoding = kEncodingCoded;
    if (byte_count < raw) return static_cast<std::uint32_t>(byte_count);
    s->models = models;
  }
  *encoding = 0;
  std::memcpy(bytes, pixels, raw);
  put_raw_rows(s, row_begin, row_count, pixels);
  return raw;
}

}  // namespace pocketray
