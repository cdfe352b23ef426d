// Points that represent an area light [Aranha07] sec. 3.1.
#pragma once
#include "plan/lamps.h"
#include "shade/frame_data.h"

namespace pocketray {

// Area of the lamp as posed.
double lamp_area(const FrameData& frame, const Lamp& lamp);

// One of several sets of points of a lamp. Their points of one index share an equal part of its area among them; the
// points of a single set lie in the middle of their parts.
struct PointSet {
  std::uint32_t index = 0, count = 1;
};

// Fills `n` points, each with an equal share of the lamp's area; returns their number, 0 without area. The mean of a flat
// lamp's points, over all sets, is its centre. Allocates nothing.
std::uint32_t place_area_light(const FrameData& frame, const Lamp& lamp, std::uint32_t n, const PointSet& set,
                               LightPoint* points);

}  // namespace pocketray
