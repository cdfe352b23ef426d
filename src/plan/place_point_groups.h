// Groups of the points of area lights, see shade/point_groups.h.
#pragma once
#include "shade/point_group.h"

namespace pocketray {

struct FrameData;

// Sets frame->lights.point_groups for the frame's lights, which must be placed; no groups if each point is to be
// tested. The arrays have at least as many elements as the frame has lights. Allocates nothing.
void place_point_groups(Array<PointGroup> groups, Array<std::uint8_t> order, Array<std::uint8_t> place,
                        FrameData* frame);

}  // namespace pocketray
