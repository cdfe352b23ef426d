// Levels of a texture (mip maps [Williams 1983, sec. 3]): each has half the width and height of the one before, rounded
// down, and at least 1. They follow the texture's own texels, level 0, in Scene::texels.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/limits.h"

namespace pocketray {

enum class TexelKind { colors, numbers };  // numbers: linear, the channels independent of each other

constexpr std::uint32_t level_side(std::uint32_t side, std::uint32_t level) {
  return side >> level ? side >> level : 1;
}

// Number of levels down to a single texel.
constexpr std::uint32_t level_count_max(std::uint32_t width, std::uint32_t height) {
  std::uint32_t count = 1;
  for (std::uint32_t side = width > height ? width : height; side > 1; side >>= 1) ++count;
  return count;
}

// Texels of the first `count` levels, which is the offset of level `count`.
constexpr std::uint32_t level_texels(std::uint32_t width, std::uint32_t height, std::uint32_t count) {
  std::uint32_t sum = 0;
  for (std::uint32_t level = 0; level < count; ++level) sum += level_side(width, level) * level_side(height, level);
  return sum;
}
static_assert(std::uint64_t(kTextureSideMax) * kTextureSideMax * 2 <= 0xFFFFFFFFu, "levels double the texels at most");

// Number of floats that make_levels() needs as scratch.
std::size_t level_scratch_need(std::uint32_t width, std::uint32_t height);

// Writes the levels after level 0, level_texels(…, level_count_max(…)) − width · height texels. A texel is the mean of
// those it covers; odd sides share the texels on the borders [Guthe & Heckbert 2005]. Colours are averaged in linear
// light, weighted by alpha so that invisible texels do not bleed in; numbers as they are, so that normals are averaged
// as vectors and normalised by the lookup. The bytes are equal on every CPU.
void make_levels(const std::uint32_t* texels, std::uint32_t width, std::uint32_t height, TexelKind kind, float* scratch,
                 std::uint32_t* levels);

}  // namespace pocketray
