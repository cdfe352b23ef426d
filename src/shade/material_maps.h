// Materials that change from point to point by their maps (MaterialMaps), use two sets of texture coordinates or have a
// clear coat. Plans with such an effect have a surface function of their own: it evaluates the surface without its
// glow, applies the maps, and adds the glow.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr EffectMask kMapEffects = bit(Effect::metallic_roughness) | bit(Effect::normal_map) | bit(Effect::occlusion) |
                                   bit(Effect::anisotropy) | bit(Effect::second_uv) | bit(Effect::clear_coat);

// Puts the maps behind the frame's surface functions, and light from FrameData::surroundings with them.
void add_material_maps(FrameData* frame);

// The lobes of the material at the surface: its own, or those that the map has put into `mapped`.
const Material& lobes_at(const FrameData& frame, const Surface& s, Material* mapped);

}  // namespace pocketray
