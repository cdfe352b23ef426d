#include "desktop/split_report/row_streams.h"

#include "base/check.h"

namespace pocketray {
namespace {

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

void send(CountedStream* counted, const std::uint8_t* pixels, RowCoding coding, bool counts) {
  const std::size_t bytes = send_picture(&counted->stream, pixels, coding);
  if (!counts) return;
  const CodecShape& shape = counted->stream.decoder->state.shape;
  const std::size_t row_bytes = shape.width * pixel_bytes(shape.format);
  double squares = 0;
  for (std::uint32_t row = 0; row < shape.height; ++row) {
    const std::uint8_t *shown = shown_row(counted->stream, row), *right = pixels + row * row_bytes;
    squares += shape.format == WireFormat::rgb565 ? squares_of<Pixel565>(shown, right, shape.width)
                                                  : squares_of<Pixel888>(shown, right, shape.width);
  }
  counted->bytes += static_cast<double>(bytes);
  counted->squares += squares / (double(shape.width) * shape.height);
}

}  // namespace

void open_row_streams(const CodecShape& shape, RowStreams* streams) {
  *streams = RowStreams();
  for (CountedStream* counted : {&streams->first, &streams->lossless, &streams->near})
    open_row_stream(shape, &counted->stream);
}

void send_picture(RowStreams* streams, const std::uint8_t* pixels, RowCoding coding) {
  CHECK(pixels != nullptr);
  const bool counts = ++streams->picture_count > 1;
  restart_row_stream(&streams->first.stream);
  send(&streams->first, pixels, coding, true);
  send(&streams->lossless, pixels, RowCoding::lossless, counts);
  send(&streams->near, pixels, RowCoding::near_lossless, counts);
}

}  // namespace pocketray
