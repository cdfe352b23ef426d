// Points that represent an area light [Aranha07] sec. 3.1.
#pragma once
#include "plan/lamps.h"
#include "shade/frame_data.h"

namespace pocketray {

// Area of the lamp as posed.
double lamp_area(const FrameData& frame, const Lamp& lamp);

// Fills `points`, Settings::points_per_area_light of them, each with an equal share of the lamp's area; returns their
// number, 0 without area. The mean of a flat lamp's points is its centre. Allocates nothing.
std::uint32_t place_area_light(const FrameData& frame, const Lamp& lamp, LightPoint* points);

}  // namespace pocketray
