// Textures in blocks of 4 × 4 texels, for a fraction of the memory. Two kinds of blocks, 8 bytes each, made by our own
// encoder and decoded in integers, so that every CPU reads equal texels:
//   - a colour block, as BC1 [Iourcha et al. 1999]: two colours of 5, 6 and 5 bits and, for each texel, 2 bits between;
//   - a plane of one channel, as BC4: two bytes and, for each texel, 3 bits between.
// Any bits are a valid block.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "scene/scene.h"
#include "scene/texture_levels.h"

namespace pocketray {

constexpr std::uint32_t kBlockSide = 4;
constexpr std::uint32_t kBlockWordsMax = 6;

// 32-bit words per block, or per texel of an exact texture.
constexpr std::uint32_t block_words(TexelFormat format) {
  switch (format) {
    case TexelFormat::exact:
      return 1;
    case TexelFormat::color4:
    case TexelFormat::red4:
      return 2;
    case TexelFormat::color_alpha8:
    case TexelFormat::green_blue8:
    case TexelFormat::normal8:
      return 4;
    case TexelFormat::numbers12:
      return 6;
  }
  return kBlockWordsMax;
}

// Blocks along a side; texels for an exact texture.
constexpr std::uint32_t block_count(TexelFormat format, std::uint32_t side) {
  return format == TexelFormat::exact ? side : (side + kBlockSide - 1) / kBlockSide;
}

// Words of the first `count` levels, which is the offset of level `count`.
constexpr std::uint32_t level_words(TexelFormat format, std::uint32_t width, std::uint32_t height,
                                    std::uint32_t count) {
  std::uint32_t sum = 0;
  for (std::uint32_t level = 0; level < count; ++level)
    sum += block_count(format, level_side(width, level)) * block_count(format, level_side(height, level)) *
           block_words(format);
  return sum;
}

// Channel of a texel in a plane: the bytes low and high, or one of the six values between them.
inline std::uint32_t plane_value(const std::uint32_t* plane, std::uint32_t texel) {
  const std::uint32_t low = plane[0] & 0xFF, high = plane[0] >> 8 & 0xFF;
  const std::uint64_t indices = (std::uint64_t(plane[1]) << 32 | plane[0]) >> 16;
  const auto index = static_cast<std::uint32_t>(indices >> 3 * texel & 7);
  return (low * (7 - index) + high * index + 3) / 7;
}

// Expands a colour of 5, 6 and 5 bits to R, G, B from the lowest byte.
constexpr std::uint32_t expanded_565(std::uint32_t c) {
  const std::uint32_t r = c >> 11 & 31, g = c >> 5 & 63, b = c & 31;
  return (r << 3 | r >> 2) | (g << 2 | g >> 4) << 8 | (b << 3 | b >> 2) << 16;
}

// R, G, B of a texel in a colour block, from the lowest byte: one of the colours, or a mix with two thirds of it.
inline std::uint32_t color_value(const std::uint32_t* block, std::uint32_t texel) {
  const std::uint32_t first = expanded_565(block[0] & 0xFFFF), last = expanded_565(block[0] >> 16);
  const std::uint32_t index = block[1] >> 2 * texel & 3;
  std::uint32_t color = 0;
  for (int shift = 0; shift < 24; shift += 8)
    color |= ((first >> shift & 0xFF) * (3 - index) + (last >> shift & 0xFF) * index + 1) / 3 << shift;
  return color;
}

// Blue of a unit normal from its red and green, each −1 at 1, 0 at 128 and 1 at 255; facing outwards.
inline std::uint32_t normal_blue(std::uint32_t red, std::uint32_t green) {
  const int x = static_cast<int>(red) - 128, y = static_cast<int>(green) - 128, rest = 127 * 127 - x * x - y * y;
  return rest > 0 ? static_cast<std::uint32_t>(128.5f + std::sqrt(static_cast<float>(rest))) : 128;
}

// A texel of a block of any format but exact: bytes R, G, B, A, from the lowest. Channels that are not stored are 255.
inline std::uint32_t block_texel(TexelFormat format, const std::uint32_t* block, std::uint32_t texel) {
  switch (format) {
    case TexelFormat::color4:
      return color_value(block, texel) | 0xFF000000u;
    case TexelFormat::color_alpha8:
      return color_value(block, texel) | plane_value(block + 2, texel) << 24;
    case TexelFormat::red4:
      return plane_value(block, texel) | 0xFFFFFF00u;
    case TexelFormat::green_blue8:
      return plane_value(block, texel) << 8 | plane_value(block + 2, texel) << 16 | 0xFF0000FFu;
    case TexelFormat::normal8: {
      const std::uint32_t red = plane_value(block, texel), green = plane_value(block + 2, texel);
      return red | green << 8 | normal_blue(red, green) << 16 | 0xFF000000u;
    }
    default:
      return plane_value(block, texel) | plane_value(block + 2, texel) << 8 | plane_value(block + 4, texel) << 16 |
             0xFF000000u;
  }
}

// Writes the blocks of a level of any format but exact: block_count(width) · block_count(height) · block_words() words.
// Deterministic: integers only, except for the length of normals.
void encode_blocks(TexelFormat format, const std::uint32_t* texels, std::uint32_t width, std::uint32_t height,
                   std::uint32_t* blocks);

}  // namespace pocketray
