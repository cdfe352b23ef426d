#include "present/image_file.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "present/pack.h"
#include "present/png_file.h"
#if defined(POCKETRAY_HAVE_PNG)
#include <png.h>
#endif

using namespace pocketray;

namespace {

std::string written;
const ByteSink kSink = {
    [](void*, const void* bytes, std::size_t count) { written.append(static_cast<const char*>(bytes), count); },
    nullptr};

std::vector<std::uint8_t> noise(int width, int height, std::uint32_t seed) {
  std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::uint8_t& level : rgb) level = static_cast<std::uint8_t>((seed = seed * 1664525 + 1013904223) >> 24);
  return rgb;
}

}  // namespace

// Goal: the files follow the formats' specifications, byte for byte. Method: two pixels by hand.
TEST_CASE("encode_ppm_and_raw_write_the_bytes_of_the_format") {
  const std::uint8_t rgb[6] = {1, 2, 3, 253, 254, 255};
  written.clear();
  encode_ppm(rgb, 2, 1, kSink);
  CHECK(written == std::string("P6\n2 1\n255\n\x01\x02\x03\xfd\xfe\xff", 17));
  const char page[] = "ab..cd..ef..";
  written.clear();
  encode_raw(page, 2, 4, 3, kSink);
  CHECK(written == "abcdef");
}
TEST_CASE("encode_pfm_writes_little_endian_rows_from_the_bottom") {
  const float values[6] = {1, -2, 0.5f, 0, 1e30f, 3};  // two rows of one pixel
  written.clear();
  encode_pfm(values, 3, 1, 2, kSink);
  std::string bottom("\x00\x00\x00\x00\xca\xf2\x49\x71\x00\x00\x40\x40", 12);  // 0, 1e30, 3
  std::string top("\x00\x00\x80\x3f\x00\x00\x00\xc0\x00\x00\x00\x3f", 12);     // 1, -2, 0.5
  CHECK(written == "PF\n1 2\n-1.0\n" + bottom + top);
  written.clear();
  encode_pfm(values, 1, 3, 2, kSink);
  CHECK(written == "Pf\n3 2\n-1.0\n" + bottom + top);
  // More than one chunk per row.
  std::vector<float> wide(1000, 1.0f);
  written.clear();
  encode_pfm(wide.data(), 1, 1000, 1, kSink);
  CHECK(written.size() == 15 + 4000);
}

// Goal: a PNG holds the picture, takes no more arena than announced and returns it. Method: noise and a gradient at
// several sizes, read back with libpng's simplified interface if there is libpng.
TEST_CASE("encode_png_round_trips_within_the_memory_announced") {
  for (int width : {1, 3, 320, 1920, 8192}) {
    CAPTURE(width);
    int height = width == 8192 ? 3 : 40;
    std::vector<std::uint8_t> rgb = noise(width, height, static_cast<std::uint32_t>(width));
    std::vector<std::uint8_t> block(encode_png_need(width) + kArenaAlignment);
    Arena arena = make_arena("frame", block.data(), block.size());
    written.clear();
    Status status = encode_png(rgb.data(), width, height, &arena, kSink);
    REQUIRE_MESSAGE(status.ok, status.message);
    CHECK(arena.used == 0);
    MESSAGE("width " << width << ": " << arena.used_max << " of " << encode_png_need(width) << " bytes of arena");
    CHECK(arena.used_max <= encode_png_need(width));

    CHECK(written.find("sRGB") != std::string::npos);
#if defined(POCKETRAY_HAVE_PNG)
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_memory(&image, written.data(), written.size()));
    image.format = PNG_FORMAT_RGB;
    CHECK(image.width == static_cast<unsigned>(width));
    CHECK(image.height == static_cast<unsigned>(height));
    std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
    REQUIRE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
    CHECK(read == rgb);
#endif
  }
}

// Goal: too little memory is a Status that states the need, wherever memory runs out. Method: every arena size in steps
// up to the need.
TEST_CASE("encode_png_says_how_much_memory_is_missing") {
  std::vector<std::uint8_t> rgb = noise(320, 8, 7);
  std::vector<std::uint8_t> block(encode_png_need(320) + kArenaAlignment);
  int failed = 0;
  for (std::size_t bytes = 64; bytes < 100'000; bytes += 1024) {
    Arena arena = make_arena("frame", block.data(), bytes);
    written.clear();
    Status status = encode_png(rgb.data(), 320, 8, &arena, kSink);
    CHECK(arena.used == 0);
    failed += !status.ok;
    if (!status.ok) CHECK(std::strstr(status.message, "bytes of memory") != nullptr);
  }
  CHECK(failed > 90);
}
