#include "scene/texture_side.h"

#include <algorithm>

#include "base/check.h"
#include "scene/texel_blocks.h"

namespace pocketray {

std::uint32_t levels_beyond(const Texture& texture, std::uint32_t side_max) {
  CHECK_GE(side_max, 1u);
  const std::uint32_t side = std::max(texture.width, texture.height);
  std::uint32_t count = 0;
  while (count + 1 < texture.level_count && level_side(side, count) > side_max) ++count;
  return count;
}

Texture without_levels_beyond(const Texture& texture, std::uint32_t side_max) {
  const std::uint32_t count = levels_beyond(texture, side_max);
  Texture rest = texture;
  rest.texel_begin += level_words(texture.format, texture.width, texture.height, count);
  rest.width = static_cast<std::uint16_t>(level_side(texture.width, count));
  rest.height = static_cast<std::uint16_t>(level_side(texture.height, count));
  rest.level_count = static_cast<std::uint8_t>(texture.level_count - count);
  CHECK_GE(rest.level_count, 1);
  return rest;
}

bool any_levels_beyond(Array<const Texture> textures, std::uint32_t side_max) {
  return std::any_of(textures.begin(), textures.end(),
                     [side_max](const Texture& texture) { return levels_beyond(texture, side_max) > 0; });
}

}  // namespace pocketray
