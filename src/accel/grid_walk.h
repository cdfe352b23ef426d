// Walks a ray through the grids. The walk follows the axis along which the ray is fastest, slice by slice of voxels,
// and in each slice visits the voxels that a ray of width `padding` touches. A voxel is thus entered whenever it
// might hold a hit, and no error accumulates from step to step as in [Fujimoto et al. 1986] or [Amanatides & Woo
// 1987].
//
// Distances are measured along that axis, in double, from the origin. The padding covers, with u = 2^-24 and R the
// farthest that the scene extends from the origin along any axis: cross_triangle() accepts hits of rays that miss the
// triangle by up to 6u R; t rounds by u R; size and inverse of voxels, floats, misplace them by 2u each of the extent,
// at most 2R. The sum is 15u R; the padding has 32u R. Double adds 2^-48 of the coordinates, and denormals 2^-100,
// which is an absolute epsilon, but voxels decide no result.
#pragma once
#include "accel/grid.h"
#include "accel/triangle.h"

namespace pocketray {

// Triangles lie in several voxels: a table indexed by their lowest bits remembers the last ones tested ("mailbox"
// [Amanatides & Woo 1987], here per ray, since several threads share the triangles).
// Measured: with 16, seesaw takes 1.2 times as long.
constexpr std::uint32_t kMailboxSize = 64;

struct GridWalk {
  const Accel& accel;
  Grid grid;
  const HitFilter* filter;
  TraceStats* stats;
  std::uint32_t clock;
  ShearedRay ray;
  int main, minor[2];          // axes
  double sign, speed;          // of the direction along the main axis
  double inverse_slope[3];     // 0 where the ray is nearly parallel
  double origin[3], slope[3];  // per unit of distance; |slope| <= 1
  double padding, limit;       // farther hits do not matter
  float t_max;
  std::uint32_t from, to;  // as in Ray
  Hit hit;
  std::uint32_t tested[kMailboxSize];
};

// Prepares a walk whose accelerator is set. Returns false if the ray hits nothing.
bool start_walk(const Ray& ray, const HitFilter* filter, TraceStats* stats, GridWalk* walk);
// Finds the closest hit and stores it in walk->hit.
void walk_to_closest(GridWalk* walk);
// Returns whether there is any hit.
bool walk_to_any(GridWalk* walk);

}  // namespace pocketray
