// Textures in blocks: what bits mean, and how close the encoder comes.
#include "scene/texel_blocks.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <vector>

#include "base/rng.h"

using namespace pocketray;

namespace {

using Texels = std::vector<std::uint32_t>;

std::uint32_t rgba(std::uint32_t r, std::uint32_t g, std::uint32_t b, std::uint32_t a = 255) {
  return r | g << 8 | b << 16 | a << 24;
}
int channel(std::uint32_t texel, int c) { return static_cast<int>(texel >> 8 * c & 0xFF); }

// The texels of a texture after encoding and decoding.
Texels round_trip(TexelFormat format, const Texels& texels, std::uint32_t width, std::uint32_t height) {
  REQUIRE(texels.size() == width * height);
  const std::uint32_t across = block_count(format, width), words = block_words(format);
  Texels blocks(across * block_count(format, height) * words), result;
  REQUIRE(blocks.size() == level_words(format, width, height, 1));
  encode_blocks(format, texels.data(), width, height, blocks.data());
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      result.push_back(block_texel(format, blocks.data() + (y / 4 * across + x / 4) * words, y % 4 * 4 + x % 4));
  return result;
}

int worst_of(const Texels& a, const Texels& b, int first, int last) {
  int worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = first; c <= last; ++c) worst = std::max(worst, std::abs(channel(a[i], c) - channel(b[i], c)));
  return worst;
}

}  // namespace

// Goal: the bits of a plane and of a colour block have the stated meaning. Method: blocks written by hand.
TEST_CASE("texel_blocks_decode_known_bits") {
  // From 10 to 80 in steps of ten; texel 0 has index 0, texel 5 index 7, texel 15 index 3.
  const std::uint64_t indices = std::uint64_t(7) << 15 | std::uint64_t(3) << 45;
  const std::uint64_t bits = 10 | 80 << 8 | indices << 16;
  const std::uint32_t plane[2] = {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
  CHECK((plane_value(plane, 0) == 10 && plane_value(plane, 5) == 80 && plane_value(plane, 15) == 40));
  // From red to blue; texels 0 to 3 have the indices 0 to 3.
  const std::uint32_t color[2] = {0xF800u | 0x001Fu << 16, 0xE4u};
  CHECK(color_value(color, 0) == 0x0000FFu);
  CHECK(color_value(color, 1) == 0x5500AAu);
  CHECK(color_value(color, 2) == 0xAA0055u);
  CHECK(color_value(color, 3) == 0xFF0000u);
  CHECK(expanded_565(0xFFFF) == 0xFFFFFFu);
  CHECK(expanded_565(0x8410) == 0x848284u);
  CHECK(normal_blue(128, 128) == 255);
  CHECK(normal_blue(255, 128) == 128);
  CHECK(normal_blue(0, 0) == 128);
  CHECK(normal_blue(128 + 76, 128) == 128 + 102);  // 0.6, 0.8
}

// Goal: blocks take the stated memory, whole ones at the edges. Method: closed forms.
TEST_CASE("texel_blocks_take_bits_as_stated") {
  CHECK(level_words(TexelFormat::exact, 64, 64, 1) * 32 == 64 * 64 * 32);
  for (TexelFormat format : {TexelFormat::color4, TexelFormat::red4})
    CHECK(level_words(format, 64, 64, 1) * 32 == 64 * 64 * 4);
  for (TexelFormat format : {TexelFormat::color_alpha8, TexelFormat::green_blue8, TexelFormat::normal8})
    CHECK(level_words(format, 64, 64, 1) * 32 == 64 * 64 * 8);
  CHECK(level_words(TexelFormat::numbers12, 64, 64, 1) * 32 == 64 * 64 * 12);
  CHECK(level_words(TexelFormat::color4, 5, 1, 3) == (2 + 1 + 1) * 2);
  CHECK(level_words(TexelFormat::exact, 5, 1, 3) == level_texels(5, 1, 3));
}

// Goal: what a block can hold is exact: one value or two in a plane, eight evenly spaced ones; two colours of 5, 6 and
// 5 bits. Method: such blocks, in random order.
TEST_CASE("texel_blocks_hold_simple_blocks_exactly") {
  Rng rng = make_rng(4);
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t low = next_u32(&rng) % 256, high = next_u32(&rng) % 256, base = next_u32(&rng) % 30;
    const std::uint32_t first = expanded_565(next_u32(&rng) & 0xFFFF), last = expanded_565(next_u32(&rng) & 0xFFFF);
    Texels two, eight, colors;
    for (int i = 0; i < 16; ++i) {
      two.push_back(rgba(next_u32(&rng) % 2 ? low : high, 0, 0));
      eight.push_back(rgba(base + 32 * (next_u32(&rng) % 8), 0, 0));
      colors.push_back((next_u32(&rng) % 2 ? first : last) | 0xFF000000u);
    }
    eight[3] = rgba(base, 0, 0), eight[7] = rgba(base + 224, 0, 0);
    CHECK(worst_of(two, round_trip(TexelFormat::red4, two, 4, 4), 0, 0) == 0);
    CHECK(worst_of(eight, round_trip(TexelFormat::red4, eight, 4, 4), 0, 0) == 0);
    CHECK(worst_of(colors, round_trip(TexelFormat::color4, colors, 4, 4), 0, 3) == 0);
  }
}

// Goal: errors of other blocks stay within what their bits allow: half a step between two of eight values; for a
// constant colour, half a step of 5 bits, less by mixing; for a gradient of grey, half of a third of its range and
// that. Method: every constant level, gradients of every length, and random blocks, whose error is at most half of a
// seventh.
TEST_CASE("texel_blocks_encoder_stays_within_its_bounds") {
  for (std::uint32_t level = 0; level < 256; ++level) {
    const Texels constant(16, rgba(level, level, 255 - level));
    CHECK(worst_of(constant, round_trip(TexelFormat::color4, constant, 4, 4), 0, 2) <= 2);
    CHECK(worst_of(constant, round_trip(TexelFormat::numbers12, constant, 4, 4), 0, 2) == 0);
    Texels gradient;
    for (std::uint32_t i = 0; i < 16; ++i) gradient.push_back(rgba(level * i / 15, level * i / 15, level * i / 15));
    const int range = static_cast<int>(level);
    CHECK(worst_of(gradient, round_trip(TexelFormat::color4, gradient, 4, 4), 0, 2) <= range / 6 + 6);
    CHECK(worst_of(gradient, round_trip(TexelFormat::green_blue8, gradient, 4, 4), 1, 2) <= range / 8 + 1);
  }
  Rng rng = make_rng(9);
  double sum = 0;
  for (int round = 0; round < 200; ++round) {
    Texels noise;
    for (int i = 0; i < 16; ++i) noise.push_back(next_u32(&rng));
    const Texels decoded = round_trip(TexelFormat::color_alpha8, noise, 4, 4);
    for (std::size_t i = 0; i < 16; ++i) {
      const double off = channel(noise[i], 3) - channel(decoded[i], 3);
      sum += off * off / (200 * 16);
    }
  }
  CHECK(sum < 36.4 * 36.4 / 12);  // steps of 255/7
}

// Goal: normals come back as unit vectors in the same direction. Method: random ones that face outwards, of any length
// that bytes hold, in blocks of one direction and its neighbours; the angle stays below two degrees.
TEST_CASE("texel_blocks_keep_the_direction_of_normals") {
  Rng rng = make_rng(6);
  double least = 1;
  for (int round = 0; round < 500; ++round) {
    Texels texels;
    const Vec3 lean = {next_float(&rng) - 0.5f, next_float(&rng) - 0.5f, 1};
    const float shortened = 0.5f + 0.5f * next_float(&rng);
    for (int i = 0; i < 16; ++i) {
      const Vec3 n = normalize(lean + Vec3{next_float(&rng) - 0.5f, next_float(&rng) - 0.5f, 0} * 0.2f) * shortened;
      auto byte = [](float x) { return static_cast<std::uint32_t>(128.5f + 127 * x); };
      texels.push_back(rgba(byte(n.x), byte(n.y), byte(n.z)));
    }
    const Texels decoded = round_trip(TexelFormat::normal8, texels, 4, 4);
    for (std::size_t i = 0; i < 16; ++i) {
      auto vector = [](std::uint32_t t) {
        return Vec3{static_cast<float>(channel(t, 0) - 128), static_cast<float>(channel(t, 1) - 128),
                    static_cast<float>(channel(t, 2) - 128)};
      };
      CHECK(length(vector(decoded[i])) == doctest::Approx(127).epsilon(0.01));
      least = std::min(least, static_cast<double>(dot(normalize(vector(texels[i])), normalize(vector(decoded[i])))));
    }
  }
  MESSAGE("least cosine ", least);
  CHECK(least > 0.99939);
}

// Goal: sides that are no multiple of four are encoded as the whole blocks would be. Method: a constant texture and two
// colours, of all small sizes.
TEST_CASE("texel_blocks_of_any_size") {
  for (std::uint32_t width = 1; width < 10; ++width)
    for (std::uint32_t height = 1; height < 10; ++height) {
      Texels texels;
      for (std::uint32_t i = 0; i < width * height; ++i) texels.push_back(i % 3 ? rgba(255, 0, 255) : rgba(0, 255, 0));
      CHECK(worst_of(texels, round_trip(TexelFormat::color4, texels, width, height), 0, 3) == 0);
      CHECK(worst_of(texels, round_trip(TexelFormat::numbers12, texels, width, height), 0, 2) == 0);
    }
}

// Goal: a plane's values lie evenly between its ends, rounded to the nearest. Method: known answers.
TEST_CASE("plane_values_are_rounded") {
  const std::uint32_t expected[] = {0, 36, 73, 109, 146, 182, 219, 255};
  for (std::uint32_t index = 0; index < 8; ++index) {
    const std::uint32_t plane[2] = {0xFF00, index << 29};  // texel 15 has the three highest bits
    CHECK(plane_value(plane, 15) == expected[index]);
    CHECK(plane_value(plane, 0) == 0);
  }
}
