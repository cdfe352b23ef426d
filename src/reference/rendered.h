// The renderer's own picture in double precision: the same samples per pixel, points of area lights, branching and
// depth, without cut-off. Only the arithmetic differs from the renderer's.
#pragma once
#include "reference/reference.h"

namespace pocketray {

// Rows [row_begin, row_end), width × rows radiances. Uses the frame's settings samples_per_pixel, ray_depth and
// points_per_area_light. Threads may share the reference.
void trace_as_rendered(const Reference& reference, std::uint32_t row_begin, std::uint32_t row_end, Vec3d* picture);

}  // namespace pocketray
