// How much of the textures a pixel covers; footprint.h computes it.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Texture area that a pixel covers, in texture coordinates; see footprint.h.
struct Footprint {
  float area;
  Vec2 axis;  // set for TextureFilter::anisotropic
};
constexpr Footprint kNoFootprint = {0, {0, 0}};
// Footprints in the first and second texture coordinates.
struct Footprints : Footprint {
  Footprint second;  // set with Effect::second_uv where the scene has them
};
constexpr Footprints kNoFootprints = {kNoFootprint, kNoFootprint};

}  // namespace pocketray
