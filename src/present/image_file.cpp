#include "present/image_file.h"

#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "base/float_bits.h"

namespace pocketray {
namespace {

void write_text(const ByteSink& sink, const char* text) { sink.write(sink.user, text, std::strlen(text)); }

void put_little_endian(float value, unsigned char* bytes) {
  std::uint32_t bits = float_bits(value);
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<unsigned char>(bits >> (8 * i));
}

}  // namespace

void encode_ppm(const std::uint8_t* rgb, int width, int height, const ByteSink& sink) {
  CHECK(rgb != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0);
  char header[48];
  std::snprintf(header, sizeof header, "P6\n%d %d\n255\n", width, height);
  write_text(sink, header);
  sink.write(sink.user, rgb, 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

void encode_pfm(const float* values, int channels, int width, int height, const ByteSink& sink,
                std::size_t line_values) {
  CHECK(channels == 1 || channels == 3);
  CHECK(values != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0);
  char header[48];
  std::snprintf(header, sizeof header, "%s\n%d %d\n-1.0\n", channels == 3 ? "PF" : "Pf", width, height);
  write_text(sink, header);
  constexpr std::size_t kChunk = 256;
  unsigned char bytes[4 * kChunk];
  std::size_t row_values = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  for (int row = height - 1; row >= 0; --row) {
    const float* in = values + static_cast<std::size_t>(row) * (line_values > 0 ? line_values : row_values);
    for (std::size_t first = 0; first < row_values; first += kChunk) {
      std::size_t count = row_values - first < kChunk ? row_values - first : kChunk;
      for (std::size_t i = 0; i < count; ++i) put_little_endian(in[first + i], bytes + 4 * i);
      sink.write(sink.user, bytes, 4 * count);
    }
  }
}

void encode_raw(const void* pixels, int row_bytes, int line_bytes, int rows, const ByteSink& sink) {
  CHECK_LE(row_bytes, line_bytes);
  CHECK(pixels != nullptr && sink.write != nullptr);
  CHECK(row_bytes > 0 && rows > 0);
  for (int row = 0; row < rows; ++row)
    sink.write(sink.user, static_cast<const unsigned char*>(pixels) + static_cast<std::ptrdiff_t>(row) * line_bytes,
               static_cast<std::size_t>(row_bytes));
}

}  // namespace pocketray
