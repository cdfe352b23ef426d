// A stored radiosity solution: the indirect light that reaches diffuse surfaces, as irradiance / π, which times the
// albedo is radiance. Flat parts of the scene carry grids, whose cells are the patches of [Bastos92]; other triangles a
// value at each corner.
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

struct RadiosityInfo {
  Vec3 value_max;  // no reconstructed value exceeds it
};

// columns × rows nodes on a plane, row by row. A point p of the plane, in the pose at time 0, has the grid coordinates
// s = (p − origin)·along_s and t = (p − origin)·along_t: node (i, j) lies at s = i, t = j.
struct RadiosityGrid {
  Vec3 origin, along_s, along_t;
  std::uint32_t columns, rows;  // ≥ 2
  std::uint32_t node_begin;
};

// A value and its derivatives by s, t, and both.
struct RadiosityNode {
  Vec3 value, ds, dt, dst;
};

// Indices into the values at the corners of a triangle.
struct RadiosityCorners {
  std::uint32_t value[3];
};

// What a side of a triangle refers to: nothing (kNone), a grid, corners, or the values with its vertices' indices.
constexpr std::uint32_t kRadiosityAtVertices = 0x7FFFFFFFu;
constexpr std::uint32_t kRadiosityGridBit = 0x80000000u;

}  // namespace pocketray
