// Textures without their largest levels: of a texture with levels, the next one then is level 0. The texels stay where
// they are; scene files on their way into memory leave them out as well (session/baked_file.h).
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Longest side of textures as models are opened. Chosen: with 1024, close-ups of 640×480 pixels are blurred
// (tests/materials/FIGURES.md); what a device has no room for, it leaves out.
constexpr std::uint32_t kTextureSideUsual = 2048;

// Number of a texture's levels that are wider or higher than `side_max` texels; never its last.
std::uint32_t levels_beyond(const Texture& texture, std::uint32_t side_max);
// The texture without these levels.
Texture without_levels_beyond(const Texture& texture, std::uint32_t side_max);
// Returns whether any texture has levels beyond `side_max`.
bool any_levels_beyond(Array<const Texture> textures, std::uint32_t side_max);

}  // namespace pocketray
