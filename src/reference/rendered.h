// The renderer's own picture in double precision: the same samples of a pixel, points of area lights, branching and
// depth, with no cut-off. What it differs by from the renderer is the arithmetic.
#pragma once
#include "reference/reference.h"

namespace pocketray {

// Rows [row_begin, row_end), width × rows radiances. Settings are those of the frame: samples_per_pixel, ray_depth,
// points_per_area_light. Threads may share the reference.
void trace_as_rendered(const Reference& reference, std::uint32_t row_begin, std::uint32_t row_end, Vec3d* picture);

}  // namespace pocketray
