#include "split_report/row_streams.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

void open_stream(const CodecShape& shape, RowStream* stream) {
  stream->memory.resize(row_encoder_need(shape) + kArenaAlignment);
  Arena arena = make_arena("whole pictures", stream->memory.data(), stream->memory.size());
  make_row_encoder(shape, &arena, &stream->encoder);
}

template <class Pixel>
double squares_of(const std::uint8_t* a, const std::uint8_t* b, std::uint32_t pixel_count) {
  double sum = 0;
  for (std::uint32_t i = 0; i < pixel_count * Pixel::kBytes; i += Pixel::kBytes)
    for (int c = 0; c < 3; ++c) {
      const double d = double(channel_of<Pixel>(Pixel::load(a + i), c)) - channel_of<Pixel>(Pixel::load(b + i), c);
      sum += d * d;
    }
  return sum / 3;
}

// From the bottom upward, as servers send rows.
void send(RowStream* stream, std::uint32_t frame, const std::uint8_t* pixels, RowCoding coding, bool counts,
          std::uint8_t* chunk) {
  const CodecState& state = stream->encoder->state;
  const std::size_t row_bytes = state.shape.width * pixel_bytes(state.shape.format);
  double squares = 0;
  for (std::uint32_t end = state.shape.height; end > 0;) {
    const std::uint32_t begin = end - std::min(end, state.shape.chunk_rows_max);
    const std::uint8_t* rows = pixels + begin * row_bytes;
    std::uint8_t encoding;
    const std::uint32_t bytes = encode_rows(stream->encoder, frame, begin, end - begin, rows, coding, chunk, &encoding);
    if (counts) stream->bytes += bytes;
    for (std::uint32_t row = begin; row < end; ++row) {
      const std::uint8_t *sent = picture_row(state, row), *right = pixels + row * row_bytes;
      squares += state.shape.format == WireFormat::rgb565 ? squares_of<Pixel565>(sent, right, state.shape.width)
                                                          : squares_of<Pixel888>(sent, right, state.shape.width);
    }
    end = begin;
  }
  if (counts) stream->squares += squares / (double(state.shape.width) * state.shape.height);
}

}  // namespace

void open_row_streams(const CodecShape& shape, RowStreams* streams) {
  *streams = RowStreams();
  for (RowStream* stream : {&streams->first, &streams->lossless, &streams->near}) open_stream(shape, stream);
  streams->chunk.resize(encoded_bytes_max(shape, shape.chunk_rows_max));
}

void send_picture(RowStreams* streams, const std::uint8_t* pixels, RowCoding coding) {
  CHECK(streams->first.encoder != nullptr && pixels != nullptr);
  const std::uint32_t frame = ++streams->picture_count;
  std::uint8_t* chunk = streams->chunk.data();
  restart_row_encoder(streams->first.encoder);
  send(&streams->first, frame, pixels, coding, true, chunk);
  send(&streams->lossless, frame, pixels, RowCoding::lossless, frame > 1, chunk);
  send(&streams->near, frame, pixels, RowCoding::near_lossless, frame > 1, chunk);
}

}  // namespace pocketray
