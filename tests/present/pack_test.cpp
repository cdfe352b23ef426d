#include "present/pack.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/limits.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr Rotation kRotations[] = {Rotation::none, Rotation::quarter, Rotation::half, Rotation::three_quarters};
constexpr PixelFormat kRgb555 = {16, {10, 5}, {5, 5}, {0, 5}, {15, 1}};
constexpr PixelFormat kBgrx8888 = {32, {8, 8}, {16, 8}, {24, 8}, {}};
constexpr PixelFormat kArgb8888 = {32, {16, 8}, {8, 8}, {0, 8}, {24, 8}};
constexpr PixelFormat kXrgb2101010 = {32, {20, 10}, {10, 10}, {0, 10}, {}};
constexpr PixelFormat kFormats[] = {kRgb565, kBgr565,   kRgb555,   kXrgb8888,    kXbgr8888,
                                    kRgb888, kBgrx8888, kArgb8888, kXrgb2101010, kBgr888};

float float_of(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// The display value 0 … 1 by the standard's formula and the C library.
double encode_exactly(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace

// Goal: the fast tone curve equals the plain one. Method: every float around each threshold and each bucket's edges,
// and a stride through all floats.
TEST_CASE("hard_64_tone_level_equals_the_search_for_every_kind_of_float") {
  count_assertions("the level of the plain search");
  ToneCounts counts;
  int wrong = 0;
  auto compare = [&](std::uint32_t bits) {
    wrong += tone_level(float_of(bits), &counts) != srgb_level(float_of(bits));
  };
  for (int level = 1; level < 256; ++level)
    for (int step = -3; step <= 3; ++step)
      compare(float_bits(kSrgb.threshold[level]) + static_cast<std::uint32_t>(step));
  for (std::uint32_t edge = 100u << 23; edge <= 130u << 23; edge += 1u << 16)
    for (int step = -1; step <= 1; ++step) compare(edge + static_cast<std::uint32_t>(step));
  for (std::uint64_t bits = 0; bits < 1ull << 32; bits += 4099) compare(static_cast<std::uint32_t>(bits));
  CHECK(wrong == 0);
  CHECK(tone_level(0.5f, &counts) == 188);
  CHECK(tone_level(0.18f, &counts) == 118);
}

// Goal: values that no display can show appear as documented and are counted once per channel. Method: one picture of
// each.
TEST_CASE("hard_64_pack_counts_nan_infinite_and_negative_radiance") {
  count_assertions("defined and counted");
  float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  Vec3 radiance[4] = {{nan, -nan, 0.5f}, {infinity, -infinity, -1}, {-0.0f, 1, 1e30f}, {-1e-40f, 0, 0.18f}};
  const std::uint8_t expected[12] = {0, 0, 188, 255, 0, 0, 0, 255, 255, 0, 0, 118};
  for (bool dither : {false, true}) {
    std::uint8_t rgb[12];
    ToneCounts counts = pack_rows(radiance, 4, 1, 0, 1, 1, kRgb888, Rotation::none, dither, rgb, sizeof rgb);
    CHECK(counts.nan == 2);
    CHECK(counts.infinite == 1);
    CHECK(counts.negative == 3);
    for (int i = 0; i < 12; ++i) CHECK(std::abs(rgb[i] - expected[i]) <= (dither ? 1 : 0));
  }
  std::uint8_t rgb[12];
  Vec3 one[1] = {{infinity, 2, 0.25f}};
  CHECK(pack_rows(one, 1, 1, 0, 1, 0, kRgb888, Rotation::none, false, rgb, 3).nan == 1);  // 0 · Inf
  CHECK(pack_rows(one, 1, 1, 0, 1, 2, kRgb888, Rotation::none, false, rgb, 3).infinite == 1);
  CHECK(rgb[2] == 188);  // exposure counts: 2 · 0.25
}

// Goal: the 16-bit curve is good enough for any dither. Method: against the formula in double precision.
TEST_CASE("tone_fine_is_within_one_of_65535") {
  double error_max = 0;
  ToneCounts counts;
  for (std::uint32_t bits = 90u << 23; bits < 128u << 23; bits += 997) {
    double exact = encode_exactly(float_of(bits)) * 65535;
    if (exact > 65535) exact = 65535;
    double error = std::fabs(tone_fine(float_of(bits), &counts) - exact);
    if (error > error_max) error_max = error;
  }
  MESSAGE("largest error of tone_fine: " << error_max << " of 65535");
  CHECK(error_max <= 1);
}

// Goal: RGB565 is idempotent and as near as five and six bits allow. Method: all 65,536 pixels, all 256 levels.
TEST_CASE("hard_65_rgb565_is_idempotent_and_near") {
  count_assertions("idempotent, error at most 4/255 (R, B), 2/255 (G)");
  for (const PixelFormat& format : {kRgb565, kBgr565}) {
    int changed = 0;
    for (std::uint32_t pixel = 0; pixel < 65536; ++pixel) {
      int levels[3];
      unpack_levels(format, pixel, levels);
      changed += pack_levels(format, levels[0], levels[1], levels[2]) != pixel;
    }
    CHECK(changed == 0);
    for (int level = 0; level < 256; ++level) {
      int levels[3];
      unpack_levels(format, pack_levels(format, level, level, level), levels);
      CHECK(std::abs(levels[0] - level) <= 4);
      CHECK(std::abs(levels[1] - level) <= 2);
      CHECK(std::abs(levels[2] - level) <= 4);
    }
  }
}

// Goal: the mean of a dithered tile is the display value to 1/64 step. Method: tiles of one colour over the whole
// range, with every rotation (the pattern rotates with the picture, so a tile stays a tile).
TEST_CASE("hard_65_dither_mean_is_within_a_64th_of_a_step") {
  count_assertions("mean within 1/64 step");
  std::vector<Vec3> radiance(64);
  std::uint16_t pixels[64];
  double error_max = 0;
  for (int i = 0; i <= 4000; ++i) {
    float linear = static_cast<float>(i) / 4000;
    for (Vec3& c : radiance) c = {linear, linear, linear};
    pack_rows(radiance.data(), 8, 8, 0, 8, 1, kRgb565, kRotations[i % 4], true, pixels, 16);
    double sums[3] = {};
    for (std::uint16_t pixel : pixels) sums[0] += pixel >> 11, sums[1] += pixel >> 5 & 63, sums[2] += pixel & 31;
    for (int channel = 0; channel < 3; ++channel) {
      double error = std::fabs(sums[channel] / 64 - encode_exactly(linear) * (channel == 1 ? 63 : 31));
      if (error > error_max) error_max = error;
    }
  }
  MESSAGE("largest error of a tile's mean: " << error_max << " steps");
  CHECK(error_max <= 1.0 / 64);
}

// Goal: dithering does not change the levels at the ends of the range, which the screen shows exactly. Method: black
// and white.
TEST_CASE("pack_dither_leaves_black_and_white_alone") {
  std::vector<Vec3> radiance(128, Vec3{0, 0, 0});
  for (int i = 64; i < 128; ++i) radiance[static_cast<std::size_t>(i)] = {1, 1, 1};
  std::uint16_t pixels[128];
  pack_rows(radiance.data(), 8, 16, 0, 16, 1, kRgb565, Rotation::none, true, pixels, 16);
  for (int i = 0; i < 128; ++i) CHECK(pixels[i] == (i < 64 ? 0 : 0xffff));
}

// Goal: with every format, rotation and odd stride each pixel is correct and in place, and nothing else is written.
// Method: a picture of random levels, packed in three pieces; read back pixel by pixel at screen_position(); guard
// bytes between the rows.
TEST_CASE("pack_places_every_pixel_in_every_format_rotation_and_stride") {
  constexpr int kWidth = 13, kHeight = 7;
  std::uint32_t seed = 1;
  std::vector<Vec3> radiance(kWidth * kHeight);
  std::vector<std::uint8_t> levels(radiance.size() * 3);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    seed = seed * 1664525 + 1013904223;
    levels[i] = static_cast<std::uint8_t>(seed >> 24);
    radiance[i / 3][static_cast<int>(i % 3)] = srgb_to_linear(levels[i]);
  }
  for (const PixelFormat& format : kFormats) {
    for (Rotation rotation : kRotations) {
      bool turned = rotation == Rotation::quarter || rotation == Rotation::three_quarters;
      int screen_width = turned ? kHeight : kWidth, screen_height = turned ? kWidth : kHeight;
      int bytes = format.bits_per_pixel / 8, line_bytes = screen_width * bytes + 4 * bytes;
      std::vector<std::uint32_t> memory(static_cast<std::size_t>(line_bytes * screen_height) / 4 + 1, 0xa5a5a5a5);
      std::uint8_t* pixels = reinterpret_cast<std::uint8_t*>(memory.data());
      for (int row : {0, 2, 5}) {
        int row_end = row == 0 ? 2 : row == 2 ? 5 : kHeight;
        pack_rows(radiance.data(), kWidth, kHeight, row, row_end, 1, format, rotation, false, pixels, line_bytes);
      }
      int wrong = 0;
      for (int row = 0; row < kHeight; ++row) {
        for (int column = 0; column < kWidth; ++column) {
          ScreenPosition at = screen_position(column, row, kWidth, kHeight, rotation);
          const std::uint8_t* level = &levels[static_cast<std::size_t>(row * kWidth + column) * 3];
          wrong += read_pixel(format, pixels + at.y * line_bytes + at.x * bytes) !=
                   pack_levels(format, level[0], level[1], level[2]);
        }
      }
      CHECK(wrong == 0);
      for (int y = 0; y < screen_height; ++y)
        for (int i = screen_width * bytes; i < line_bytes; ++i) wrong += pixels[y * line_bytes + i] != 0xa5;
      CHECK(wrong == 0);
    }
  }
}

// Goal: equal neighbours get the same pixel, and what no display shows is counted in each of them. Method: a row of
// pixels from few values, so that neighbours are often equal or differ in one channel; each pixel packed by itself.
TEST_CASE("pack_of_equal_neighbours_equals_pixels_by_themselves") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const float values[] = {0.18f, 0.5f, -0.0f, -1, nan, infinity, kRadianceMax, 1e30f};
  constexpr int kWidth = 4096;
  for (float exposure : {1.0f, 0x1p-40f, 0x1p60f}) {
    std::vector<Vec3> radiance(kWidth);
    std::uint32_t seed = 3;
    for (int column = 0; column < kWidth; ++column) {
      radiance[static_cast<std::size_t>(column)] = column ? radiance[static_cast<std::size_t>(column - 1)] : Vec3{};
      seed = seed * 1664525 + 1013904223;
      if (seed >> 31) radiance[static_cast<std::size_t>(column)][(seed >> 26) % 3] = values[(seed >> 28) % 8];
    }
    for (bool dither : {false, true}) {
      std::vector<std::uint8_t> rgb(3 * kWidth);
      ToneCounts counts = pack_rows(radiance.data(), kWidth, 1, 0, 1, exposure, kRgb888, Rotation::none, dither,
                                    rgb.data(), 3 * kWidth),
                 expected;
      int wrong = 0;
      for (int column = 0; column < kWidth; ++column) {
        std::uint8_t one[3];
        const Vec3* at = &radiance[static_cast<std::size_t>(column)];
        expected += pack_rows(at, 1, 1, 0, 1, exposure, kRgb888, Rotation::none, false, one, 3);
        if (!dither) wrong += std::memcmp(one, &rgb[static_cast<std::size_t>(3 * column)], 3) != 0;
      }
      CHECK(wrong == 0);
      CHECK(counts.nan == expected.nan);
      CHECK(counts.infinite == expected.infinite);
      CHECK(counts.negative == expected.negative);
      CHECK(expected.nan > 100);
      CHECK(expected.negative > 100);
    }
  }
}

// Goal: rotation works as documented. Method: the corners of a 3 × 2 picture, by hand.
TEST_CASE("pack_rotation_turns_clockwise") {
  // A clockwise quarter turn moves the top left corner to the top right.
  CHECK(screen_position(0, 0, 3, 2, Rotation::quarter).x == 1);
  CHECK(screen_position(0, 0, 3, 2, Rotation::quarter).y == 0);
  CHECK(screen_position(2, 0, 3, 2, Rotation::quarter).y == 2);
  CHECK(screen_position(0, 0, 3, 2, Rotation::half).x == 2);
  CHECK(screen_position(0, 0, 3, 2, Rotation::half).y == 1);
  CHECK(screen_position(0, 0, 3, 2, Rotation::three_quarters).x == 0);
  CHECK(screen_position(0, 0, 3, 2, Rotation::three_quarters).y == 2);
  Rotation rotation;
  CHECK(rotation_from_degrees(270, &rotation));
  CHECK(rotation == Rotation::three_quarters);
  CHECK_FALSE(rotation_from_degrees(45, &rotation));
  CHECK_FALSE(rotation_from_degrees(-90, &rotation));
}

// Goal: formats that a driver may report but we cannot write are refused. Method: one of each kind.
TEST_CASE("pixel_format_valid_refuses_what_cannot_be_packed") {
  for (const PixelFormat& format : kFormats) CHECK(pixel_format_valid(format));
  CHECK_FALSE(pixel_format_valid({8, {0, 3}, {3, 3}, {6, 2}, {}}));
  CHECK_FALSE(pixel_format_valid({16, {11, 5}, {5, 6}, {0, 0}, {}}));  // no blue
  CHECK_FALSE(pixel_format_valid({16, {11, 5}, {5, 6}, {1, 5}, {}}));  // overlap
  CHECK_FALSE(pixel_format_valid({16, {12, 5}, {5, 6}, {0, 5}, {}}));  // outside the pixel
  CHECK_FALSE(pixel_format_valid({32, {16, 8}, {8, 8}, {-1, 8}, {}}));
  CHECK_FALSE(pixel_format_valid({32, {20, 12}, {8, 12}, {0, 8}, {}}));  // more bits than we have
}

// Goal: pixels of spans are the bytes that pack_rows() writes for them, wherever they go. Method: spans of every length
// in a picture of odd size, every format, with and without dither, into unaligned memory.
TEST_CASE("pack_spans_equal_the_rows_they_are_of") {
  constexpr int kWidth = 13, kHeight = 11;
  std::vector<Vec3> radiance(kWidth * kHeight);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    float x = static_cast<float>(i) / (kWidth * kHeight);
    radiance[static_cast<std::size_t>(i)] = {x * 1.3f, 1 - x, x * x};
  }
  std::vector<Span> spans;
  for (int row = kHeight - 1; row >= 0; --row)
    for (int begin = row % 3; begin <= kWidth; begin += 4)
      spans.push_back({static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin),
                       static_cast<std::uint16_t>(begin + (row + begin) % (kWidth - begin + 1))});
  for (const PixelFormat& format : kFormats)
    for (bool dither : {false, true}) {
      std::size_t bytes = static_cast<std::size_t>(format.bits_per_pixel / 8);
      std::vector<std::uint32_t> rows(kWidth * kHeight);
      auto* whole = reinterpret_cast<unsigned char*>(rows.data());
      int line_bytes = kWidth * static_cast<int>(bytes);
      if (bytes == 2) line_bytes += 2 * (kWidth % 2);
      pack_rows(radiance.data(), kWidth, kHeight, 0, kHeight, 0.9f, format, Rotation::none, dither, whole, line_bytes);
      std::vector<unsigned char> packed(1 + spans.size() * kWidth * bytes, 0xab);
      pack_spans(radiance.data(), kWidth, spans.data(), static_cast<std::uint32_t>(spans.size()), 0.9f, format, dither,
                 packed.data() + 1);
      const unsigned char* at = packed.data() + 1;
      for (const Span& span : spans)
        for (int column = span.column_begin; column < span.column_end; ++column, at += bytes)
          CHECK(std::memcmp(at, whole + span.row * line_bytes + column * static_cast<int>(bytes), bytes) == 0);
      CHECK(*at == 0xab);
    }
}

// Goal: the film tone is Khronos PBR Neutral without its offset: .8 of white and less stay; above, the largest channel
// approaches white, and the colour fades to white, too. Method: the published formula in double precision, to within a
// level; what no display shows is counted as without the tone.
TEST_CASE("pack_tone_film_fades_to_white") {
  auto levels_of = [](const Vec3& c, Tone tone, std::uint8_t* rgb) {
    return pack_rows(&c, 1, 1, 0, 1, Display(2, tone), kRgb888, Rotation::none, false, rgb, 3);
  };
  int last[3] = {0, 0, 0}, differing = 0;
  for (float most = 0x1p-8f; most < 1e17f; most *= 1.01f) {
    const Vec3 c = Vec3{1, 0.5f, 0.25f} * most;
    std::uint8_t film[3], clip[3];
    levels_of(c, Tone::film, film), levels_of(c, Tone::clip, clip);
    const double start = 0.8, d = 1 - start, peak = 2 * double(most), above = 1 - d * d / (peak + d - start);
    const double g = 1 - 1 / (0.15 * (peak - above) + 1);
    CAPTURE(most);
    for (int i = 0; i < 3; ++i) {
      const double faded = std::ldexp(above, -i) * (1 - g) + above * g;
      CHECK(std::abs(film[i] - srgb_level(static_cast<float>(peak < start ? std::ldexp(peak, -i) : faded))) <=
            (peak < start ? 0 : 1));
      if (peak < start) CHECK(film[i] == clip[i]);
      differing += film[i] != clip[i];
      CHECK(film[i] >= last[i]);
      last[i] = film[i];
    }
  }
  CHECK(differing > 1000);
  for (int level : last) CHECK(level == 255);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  std::uint8_t rgb[3];
  CHECK(levels_of({nan, 2, -1}, Tone::film, rgb).nan == 1);
  CHECK((rgb[0] == 0 && rgb[1] > 200 && rgb[2] == 0));
  CHECK(levels_of({infinity, 2, -1}, Tone::film, rgb).infinite == 1);
  CHECK((rgb[0] == 255 && rgb[2] == 0));
  CHECK(levels_of({1e30f, 0, -1}, Tone::film, rgb).negative == 1);
  CHECK((rgb[0] == 255 && rgb[1] == 0 && rgb[2] == 0));
}
