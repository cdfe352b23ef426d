#include "base/check.h"
#include "wire/block_coder.h"

namespace pocketray {
namespace {

bool decode_coded(CodecState* s, const RowChunk& chunk) {
  // The coder reads zeros past the end, so encoders omit trailing zeros.
  if (chunk.bytes.count > 0 && chunk.bytes[chunk.bytes.count - 1] == 0) return false;
  RangeDecoder coder(chunk.bytes.data, chunk.bytes.count);
  auto chosen = [](const Block&, const BlockChoice&, const BlockChoice&, BlockChoice*) {};
  const std::uint32_t begin = chunk.row_begin, end = begin + chunk.row_count;
  bool fits = s->shape.format == WireFormat::rgb565 ? code_blocks<Pixel565>(&coder, s, begin, end, nullptr, 0, chosen)
                                                    : code_blocks<Pixel888>(&coder, s, begin, end, nullptr, 0, chosen);
  return fits && coder.is_at_end();
}

bool decode_chunk(CodecState* s, const RowChunk& chunk) {
  if (chunk.row_count == 0 || chunk.row_count > s->shape.chunk_rows_max ||
      chunk.row_begin > s->shape.height - chunk.row_count)
    return false;
  if ((chunk.encoding & ~kEncodingCoded) != 0) return false;
  const std::uint32_t byte_count = raw_bytes(s->shape, chunk.row_count);
  const bool coded = (chunk.encoding & kEncodingCoded) != 0;
  if (coded ? chunk.bytes.count > byte_count : chunk.bytes.count != byte_count) return false;
  begin_rows(s, chunk.frame, chunk.row_begin, chunk.row_count);
  if (coded) return decode_coded(s, chunk);
  put_raw_rows(s, chunk.row_begin, chunk.row_count, chunk.bytes.data);
  return true;
}

}  // namespace

std::size_t row_decoder_need(const CodecShape& shape) {
  return arena_need(sizeof(RowDecoder)) + codec_state_need(shape);
}

void make_row_decoder(const CodecShape& shape, Arena* arena, RowDecoder** decoder) {
  CHECK(arena != nullptr && decoder != nullptr);
  *decoder = arena_array<RowDecoder>(arena, 1).data;
  make_codec_state(shape, arena, &(*decoder)->state);
}

void restart_row_decoder(RowDecoder* decoder) {
  CHECK(decoder != nullptr);
  restart_codec_state(&decoder->state);
}

bool decode_rows(RowDecoder* decoder, const RowChunk& chunk) {
  CHECK(decoder != nullptr);
  CHECK(chunk.bytes.data != nullptr || chunk.bytes.count == 0);
  if (decoder->state.broken) return false;
  decoder->state.broken = !decode_chunk(&decoder->state, chunk);
  return !decoder->state.broken;
}

}  // namespace pocketray
