// codec_cost 565|888 DECODES FRAME.ppm… : codes the frames as a server sends them, in chunks of 24 rows, and decodes
// each chunk DECODES times, 0 or 1. codec_cost.py counts the instructions.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "wire/codec.h"

using namespace pocketray;

namespace {

using Bytes = std::vector<std::uint8_t>;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "codec_cost: %s\n", what);
  std::exit(1);
}

// Pixels of a binary PPM with 8 bits a channel, in the format.
Bytes read_frame(const char* path, WireFormat format, std::uint32_t* width, std::uint32_t* height) {
  std::FILE* file = std::fopen(path, "rb");
  if (!file || std::fscanf(file, "P6 %u %u 255", width, height) != 2) fail(path);
  std::fgetc(file);
  Bytes rgb(std::size_t(*width) * *height * 3);
  if (std::fread(rgb.data(), 1, rgb.size(), file) != rgb.size()) fail(path);
  std::fclose(file);
  if (format == WireFormat::rgb888) return rgb;
  Bytes pixels;
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    auto level = [&](std::size_t c, std::uint32_t most) { return (rgb[i + c] * most + 127) / 255; };
    const std::uint32_t pixel = level(0, 31) << 11 | level(1, 63) << 5 | level(2, 31);
    pixels.push_back(static_cast<std::uint8_t>(pixel)), pixels.push_back(static_cast<std::uint8_t>(pixel >> 8));
  }
  return pixels;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count < 4) return 2;
  const WireFormat format = std::strcmp(arguments[1], "565") == 0 ? WireFormat::rgb565 : WireFormat::rgb888;
  const int decodes = std::atoi(arguments[2]);
  CodecShape shape;
  shape.format = format;
  std::vector<Bytes> frames;
  for (int i = 3; i < argument_count; ++i)
    frames.push_back(read_frame(arguments[i], format, &shape.width, &shape.height));
  shape.chunk_rows_max = 24;
  Bytes block(row_encoder_need(shape) + row_decoder_need(shape) + kArenaAlignment);
  Bytes coded(encoded_bytes_max(shape, shape.chunk_rows_max));
  Arena arena = make_arena("codec", block.data(), block.size());
  RowEncoder* encoder;
  RowDecoder* decoder;
  make_row_encoder(shape, &arena, &encoder);
  make_row_decoder(shape, &arena, &decoder);
  std::size_t bytes = 0;
  const std::size_t row_bytes = shape.width * pixel_bytes(format);
  for (std::uint32_t frame = 0; frame < frames.size(); ++frame)
    for (std::uint32_t end = shape.height; end > 0;) {
      const std::uint32_t begin = end > shape.chunk_rows_max ? end - shape.chunk_rows_max : 0;
      RowChunk chunk;
      chunk.frame = frame + 1;
      chunk.row_begin = static_cast<std::uint16_t>(begin), chunk.row_count = static_cast<std::uint16_t>(end - begin);
      const std::uint32_t count =
          encode_rows(encoder, chunk.frame, begin, end - begin, &frames[frame][begin * row_bytes], RowCoding::lossless,
                      coded.data(), &chunk.encoding);
      chunk.bytes = {coded.data(), count};
      if (decodes > 0 && !decode_rows(decoder, chunk)) fail("a chunk cannot be decoded");
      if (frame > 0) bytes += count;
      end = begin;
    }
  std::printf("%zu\n", frames.size() > 1 ? bytes / (frames.size() - 1) : 0);
  return 0;
}
