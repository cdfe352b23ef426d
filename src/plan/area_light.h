// Points that represent an area light, an emissive material [Aranha07] sec. 3.1.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Fills `points`, Settings::points_per_area_light of them, each with an equal share of the material's area; returns
// their number, 0 if it has no area. Their mean is the centre of the light if that is flat. Allocates nothing.
std::uint32_t place_area_light(const FrameData& frame, std::uint32_t material, LightPoint* points);

}  // namespace pocketray
