// Materials that vary by maps (MaterialMaps), use two sets of texture coordinates or have a clear coat or sheen. Plans
// with such an effect have their own surface function: it evaluates the surface without its glow, applies the maps, and
// adds the glow.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// Applies the maps after the frame's surface functions, and adds the light of Kernels::surroundings.
void add_material_maps(FrameData* frame);

// Returns the material's lobes at the surface: its own, or those modified by the map and stored in `mapped`.
const Material& lobes_at(const FrameData& frame, const Surface& s, Material* mapped);

}  // namespace pocketray
