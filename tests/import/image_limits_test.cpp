// Pictures that promise one size and hold another.
#include <doctest/doctest.h>
#include <zlib.h>

#include <cstring>

#include "desktop/import/image.h"

using namespace pocketray;

namespace {

void put_be32(std::uint32_t value, Bytes* bytes) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes->push_back(static_cast<std::uint8_t>(value >> shift));
}

void put_chunk(const char* type, const Bytes& data, Bytes* png) {
  put_be32(static_cast<std::uint32_t>(data.size()), png);
  const std::size_t begin = png->size();
  png->insert(png->end(), type, type + 4);
  png->insert(png->end(), data.begin(), data.end());
  put_be32(static_cast<std::uint32_t>(crc32(0, png->data() + begin, static_cast<uInt>(data.size() + 4))), png);
}

// An RGB picture that says it has that size and holds that many bytes, filters included.
Bytes make_png(std::uint32_t width, std::uint32_t height, std::size_t byte_count) {
  Bytes header, data, png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  put_be32(width, &header), put_be32(height, &header);
  for (std::uint8_t value : {8, 2, 0, 0, 0}) header.push_back(value);
  const Bytes plain(byte_count);
  uLongf length = compressBound(static_cast<uLong>(byte_count));
  data.resize(length);
  REQUIRE(compress2(data.data(), &length, plain.data(), static_cast<uLong>(byte_count), 9) == Z_OK);
  data.resize(length);
  put_chunk("IHDR", header, &png), put_chunk("IDAT", data, &png), put_chunk("IEND", Bytes(), &png);
  return png;
}

std::string refusal(const Bytes& bytes) {
  Image image;
  const Status status = read_image(bytes, "a.png", std::size_t(1) << 28, &image);
  return status.ok ? "" : status.message;
}

}  // namespace

// Goal: a PNG takes memory for its pixels, not for what it inflates to, and is refused if that is more. Method: 64 MiB
// in pictures of one pixel and of some, beside whole ones.
TEST_CASE("image_inflates_to_its_pixels_at_most") {
  CHECK(refusal(make_png(1, 1, 4)).empty());
  CHECK(refusal(make_png(300, 200, 200 * 901)).empty());
  for (std::uint32_t side : {1u, 64u})
    CHECK(refusal(make_png(side, side, 64u << 20)).find("holds more data than these need") != std::string::npos);
}

// Goal: no memory is taken for pixels that a file is too short for. Method: pictures that say they have 10⁸ of them, in
// some hundred bytes.
TEST_CASE("image_has_no_more_pixels_than_its_bytes_can_hold") {
  CHECK(refusal(make_png(10'000, 10'000, 100)).find("bytes can hold") != std::string::npos);
  Bytes tga = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x10, 0x27, 0x10, 0x27, 24, 0};
  CHECK(refusal(tga).find("bytes can hold") != std::string::npos);
  Bytes jpeg = {0xff, 0xd8, 0xff, 0xc0, 0,    17, 8, 0x27, 0x10, 0x27, 0x10, 3,
                1,    0x11, 0,    2,    0x11, 0,  3, 0x11, 0,    0xff, 0xda};
  CHECK(refusal(jpeg).find("bytes can hold") != std::string::npos);
}
