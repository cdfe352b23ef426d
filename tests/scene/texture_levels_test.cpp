// Smaller levels of textures: sizes, places and means.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "base/color.h"
#include "base/rng.h"
#include "scene/texture_levels.h"

using namespace pocketray;

namespace {

using Texels = std::vector<std::uint32_t>;

std::uint32_t rgba(int r, int g, int b, int a = 255) {
  const std::uint8_t bytes[4] = {static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                                 static_cast<std::uint8_t>(b), static_cast<std::uint8_t>(a)};
  std::uint32_t texel;
  std::memcpy(&texel, bytes, sizeof texel);
  return texel;
}
int channel(std::uint32_t texel, int c) {
  std::uint8_t bytes[4];
  std::memcpy(bytes, &texel, sizeof bytes);
  return bytes[c];
}

// All levels after the first.
Texels levels_of(const Texels& texels, std::uint32_t width, std::uint32_t height, TexelKind kind) {
  REQUIRE(texels.size() == width * height);
  std::vector<float> scratch(level_scratch_need(width, height));
  Texels levels(level_texels(width, height, level_count_max(width, height)) - texels.size());
  make_levels(texels.data(), width, height, kind, scratch.data(), levels.data());
  return levels;
}

}  // namespace

// Goal: levels halve down to one texel and lie one behind the other. Method: closed forms, up to the largest texture.
TEST_CASE("texture_levels_halve_down_to_one_texel") {
  CHECK(level_count_max(1, 1) == 1);
  CHECK(level_count_max(512, 512) == 10);
  CHECK(level_count_max(3, 2) == 2);
  CHECK(level_count_max(1, kTextureSideMax) == 15);
  CHECK((level_side(5, 0) == 5 && level_side(5, 1) == 2 && level_side(5, 2) == 1 && level_side(5, 14) == 1));
  CHECK(level_texels(4, 2, 0) == 0);
  CHECK(level_texels(4, 2, 1) == 8);
  CHECK(level_texels(4, 2, 3) == 8 + 2 + 1);
  CHECK(level_texels(kTextureSideMax, kTextureSideMax, 15) == 0x15555555u);
}

// Goal: colours are averaged in linear light, numbers as they are. Method: a chequerboard of black and white, whose
// mean is 188 as a colour (HARDCASES row 64) and 128 as a number, at every level.
TEST_CASE("texture_levels_average_colors_in_linear_light") {
  Texels board(8 * 8);
  for (std::uint32_t i = 0; i < 64; ++i) board[i] = (i + i / 8) % 2 ? rgba(255, 255, 255) : rgba(0, 0, 0);
  for (std::uint32_t texel : levels_of(board, 8, 8, TexelKind::colors)) CHECK(texel == rgba(188, 188, 188));
  for (std::uint32_t texel : levels_of(board, 8, 8, TexelKind::numbers)) CHECK(texel == rgba(128, 128, 128));
}

// Goal: invisible texels do not bleed in, but count where nothing else is there. Method: closed forms; alpha itself is
// the plain mean.
TEST_CASE("texture_levels_weight_colors_by_alpha") {
  CHECK(levels_of({rgba(200, 0, 0, 255), rgba(0, 255, 0, 0)}, 2, 1, TexelKind::colors) == Texels{rgba(200, 0, 0, 128)});
  CHECK(levels_of({rgba(9, 80, 7, 0), rgba(9, 80, 7, 0)}, 1, 2, TexelKind::colors) == Texels{rgba(9, 80, 7, 0)});
  CHECK(levels_of({rgba(200, 4, 0, 255), rgba(0, 8, 90, 1)}, 2, 1, TexelKind::numbers) ==
        Texels{rgba(100, 6, 45, 128)});
}

// Goal: odd sides lose no texel, and each counts the same. Method: closed forms of three and five texels.
TEST_CASE("texture_levels_of_odd_sides_cover_all_texels") {
  CHECK(levels_of({rgba(30, 0, 0), rgba(60, 0, 0), rgba(90, 30, 0)}, 3, 1, TexelKind::numbers) ==
        Texels{rgba(60, 10, 0)});
  // Shares 2 : 2 : 1 and 1 : 2 : 2 of five.
  const Texels levels = levels_of({rgba(100, 0, 0), rgba(0, 100, 0), rgba(0, 0, 100), rgba(0, 100, 0), rgba(50, 0, 0)},
                                  5, 1, TexelKind::numbers);
  CHECK(levels == Texels{rgba(40, 40, 20), rgba(20, 40, 20), rgba(30, 40, 20)});
}

// Goal: every level keeps the mean of the texture. Method: random numbers of many sizes; the last level is the mean to
// within the rounding of one texel, and a constant texture stays what it is, in either kind.
TEST_CASE("texture_levels_keep_the_mean") {
  Rng rng = make_rng(77);
  for (std::uint32_t width : {1u, 2u, 3u, 7u, 16u, 33u})
    for (std::uint32_t height : {1u, 2u, 5u, 16u, 31u}) {
      if (width * height == 1) continue;
      Texels texels(width * height), constant(width * height, rgba(17, 111, 240, 90));
      double sum[4] = {0, 0, 0, 0};
      for (std::uint32_t& texel : texels) {
        texel = next_u32(&rng);
        for (int c = 0; c < 4; ++c) sum[c] += channel(texel, c);
      }
      const Texels levels = levels_of(texels, width, height, TexelKind::numbers);
      CAPTURE(width);
      CAPTURE(height);
      for (int c = 0; c < 4; ++c) CHECK(std::abs(channel(levels.back(), c) - sum[c] / (width * height)) < 0.501);
      for (TexelKind kind : {TexelKind::colors, TexelKind::numbers})
        for (std::uint32_t texel : levels_of(constant, width, height, kind)) CHECK(texel == constant[0]);
    }
}
