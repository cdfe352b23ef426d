// A stored radiosity solution: the indirect light on diffuse surfaces as irradiance / π, which times the albedo is
// radiance. Flat parts of the scene have grids, whose cells are the patches of [Bastos92]; other triangles have a value
// at each corner, and large ones at the corners of the parts into which they are halved.
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

// Reference of a triangle's side: to nothing (kNone), a grid, corners, the values with its vertices' indices, a split, or
// a cut.
constexpr std::uint32_t kRadiosityAtVertices = 0x7FFFFFFFu;
constexpr std::uint32_t kRadiosityGridBit = 0x80000000u;

// A triangle halved at the middle M of an edge AB, opposite C, into AMC and MBC. A reference to it has
// kRadiositySplitBit and, as its turn, the position of A among the corners of the triangle. Its parts are such
// references, or indices of corners; from bit kRadiosityLevelShift on, part[0] has the level of the split itself: parts
// have higher levels.
struct RadiositySplit {
  std::uint32_t part[2];
};
constexpr std::uint32_t kRadiositySplitBit = 0x40000000u;
constexpr int kRadiosityTurnShift = 28, kRadiosityLevelShift = 23;
constexpr std::uint32_t kRadiosityPartMax = (1u << kRadiosityLevelShift) - 1, kRadiosityLevelMax = 31;

// Divides a flat part along a line at which its light changes at once, such as the foot of a partition. Points p with
// (p − origin)·across > 0 have part[1]. A reference to it has kRadiosityCutBits; parts are grids or cuts of higher
// indices.
struct RadiosityCut {
  Vec3 origin, across;
  std::uint32_t part[2];
};
constexpr std::uint32_t kRadiosityCutBits = kRadiosityGridBit | kRadiositySplitBit;

inline bool is_cut(std::uint32_t place) { return place >= kRadiosityCutBits && place != 0xFFFFFFFFu; }

inline bool is_split(std::uint32_t place) {
  return (place & (kRadiosityGridBit | kRadiositySplitBit)) == kRadiositySplitBit && place != kRadiosityAtVertices;
}
inline std::uint32_t turn_of(std::uint32_t place) { return place >> kRadiosityTurnShift & 3; }
inline std::uint32_t level_of(const RadiositySplit& split) {
  return split.part[0] >> kRadiosityLevelShift & kRadiosityLevelMax;
}

}  // namespace pocketray
