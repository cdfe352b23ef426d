#pragma once
#include "accel/grid.h"

namespace pocketray {

// Divides a voxel that a ray has entered [Jevans 1992] sec. 3.1. Returns the new value of its `child`: still
// kNotSubdivided if another thread is at work or the pool has no room. Called during a GridVisit.
std::uint32_t subdivide(const Accel& accel, std::uint32_t parent, std::uint32_t cell);

}  // namespace pocketray
