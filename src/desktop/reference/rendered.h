// The renderer's own picture in double precision: with equal samples per pixel, points of area lights, branching and
// depth, but no cut-off. Only the arithmetic differs.
#pragma once
#include "desktop/reference/reference.h"

namespace pocketray {

// Traces rows [row_begin, row_end), width × rows radiances. Uses the frame's settings samples_per_pixel, ray_depth and
// points_per_area_light. Threads may share the reference.
void trace_as_rendered(const Reference& reference, std::uint32_t row_begin, std::uint32_t row_end, Vec3d* picture);

}  // namespace pocketray
