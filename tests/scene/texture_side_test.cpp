// Textures without their largest levels.
#include "scene/texture_side.h"

#include <doctest/doctest.h>

#include "scene/texel_blocks.h"

using namespace pocketray;

namespace {

Texture texture_of(std::uint16_t width, std::uint16_t height, std::uint32_t level_count, TexelFormat format) {
  Texture t = {};
  t.texel_begin = 7, t.width = width, t.height = height, t.format = format;
  t.level_count = static_cast<std::uint8_t>(level_count);
  return t;
}

}  // namespace

// Goal: each level left in is where it was, with its sides, in every format. Method: odd and unequal sides, every
// limit up to the largest side.
TEST_CASE("texture_side_keeps_the_levels_within_it") {
  const std::uint16_t sides[][2] = {{1, 1}, {2, 1}, {64, 64}, {37, 5}, {5, 37}, {100, 1}};
  for (const auto& side : sides)
    for (int format = 0; format < kTexelFormatCount; ++format) {
      const std::uint32_t level_count = level_count_max(side[0], side[1]);
      const Texture whole = texture_of(side[0], side[1], level_count, static_cast<TexelFormat>(format));
      for (std::uint32_t side_max = 1; side_max <= 101; ++side_max) {
        CAPTURE(side_max);
        const Texture rest = without_levels_beyond(whole, side_max);
        const std::uint32_t left_out = levels_beyond(whole, side_max);
        REQUIRE(left_out + rest.level_count == level_count);
        CHECK(std::max(rest.width, rest.height) <= side_max);
        if (left_out > 0)
          CHECK(std::max(level_side(side[0], left_out - 1), level_side(side[1], left_out - 1)) > side_max);
        for (std::uint32_t level = 0; level < rest.level_count; ++level) {
          CHECK(level_side(rest.width, level) == level_side(whole.width, level + left_out));
          CHECK(level_side(rest.height, level) == level_side(whole.height, level + left_out));
          CHECK(rest.texel_begin + level_words(rest.format, rest.width, rest.height, level) ==
                whole.texel_begin + level_words(whole.format, whole.width, whole.height, level + left_out));
        }
        CHECK(any_levels_beyond({&whole, 1}, side_max) == (left_out > 0));
      }
    }
}

// Goal: the last level stays, however small the limit: a texture without levels keeps its size.
TEST_CASE("texture_side_leaves_the_last_level") {
  const Texture plain = texture_of(64, 64, 1, TexelFormat::exact);
  CHECK(levels_beyond(plain, 1) == 0);
  CHECK(without_levels_beyond(plain, 1).width == 64);
  const Texture cut_short = texture_of(64, 64, 3, TexelFormat::exact);
  const Texture rest = without_levels_beyond(cut_short, 1);
  CHECK(rest.width == 16);
  CHECK(rest.level_count == 1);
  CHECK(rest.texel_begin == 7 + 64 * 64 + 32 * 32);
}
