#include "desktop/accuracy/network/row_stream.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {

void open_row_stream(const CodecShape& shape, RowStream* stream) {
  CHECK(codec_shape_valid(shape));
  *stream = RowStream();
  stream->memory.resize(row_encoder_need(shape) + row_decoder_need(shape) + kArenaAlignment);
  stream->chunk.resize(encoded_bytes_max(shape, shape.chunk_rows_max));
  Arena arena = make_arena("row stream", stream->memory.data(), stream->memory.size());
  make_row_encoder(shape, &arena, &stream->encoder);
  make_row_decoder(shape, &arena, &stream->decoder);
}

void restart_row_stream(RowStream* stream) {
  CHECK(stream->encoder != nullptr);
  restart_row_encoder(stream->encoder);
  restart_row_decoder(stream->decoder);
}

std::size_t send_picture(RowStream* stream, const std::uint8_t* pixels, RowCoding coding) {
  CHECK(stream->encoder != nullptr && pixels != nullptr);
  const CodecShape& shape = stream->encoder->state.shape;
  const std::size_t row_bytes = std::size_t(shape.width) * pixel_bytes(shape.format);
  std::size_t bytes = 0;
  RowChunk chunk;
  chunk.frame = ++stream->picture_count;
  for (std::uint32_t end = shape.height; end > 0;) {
    const std::uint32_t begin = end - std::min(end, shape.chunk_rows_max);
    const std::uint32_t count = encode_rows(stream->encoder, chunk.frame, begin, end - begin,
                                            pixels + begin * row_bytes, coding, stream->chunk.data(), &chunk.encoding);
    CHECK_LE(count, stream->chunk.size());
    chunk.row_begin = static_cast<std::uint16_t>(begin), chunk.row_count = static_cast<std::uint16_t>(end - begin);
    chunk.bytes = {stream->chunk.data(), count};
    CHECK(decode_rows(stream->decoder, chunk));  // what was just encoded
    bytes += count;
    end = begin;
  }
  return bytes;
}

const std::uint8_t* shown_row(const RowStream& stream, std::uint32_t row) {
  CHECK(stream.decoder != nullptr);
  CHECK_LT(row, stream.decoder->state.shape.height);
  return picture_row(stream.decoder->state, row);
}

}  // namespace pocketray
