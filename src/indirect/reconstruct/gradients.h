// Gradients of the light that triangles store at their corners, for the elements of triangle.h.
#pragma once
#include "base/arena.h"
#include "scene/scene.h"

namespace pocketray {

// Derivatives along the axes of the world, in the pose at time 0.
struct RadiosityGradient {
  Vec3 dx, dy, dz;
  Vec3 along(const Vec3& way) const { return dx * way.x + dy * way.y + dz * way.z; }
};

// A part of a triangle, with the positions of its corners.
struct RadiosityPart {
  RadiosityCorners corners;
  Vec3 place[3];
};

// The two halves of a split triangle, as indices into its corners A, B and C (see RadiositySplit).
struct HalvedCorners {
  std::uint32_t a, b, c;
};
inline HalvedCorners halved_corners(std::uint32_t place) {
  const std::uint32_t turn = turn_of(place);
  return {turn, turn < 2 ? turn + 1 : 0, turn ? turn - 1 : 2};
}

// Bytes of the gradients, and bytes that set_gradients() needs while it works.
std::size_t gradients_need(const Scene& scene);
std::size_t gradients_scratch_need(const Scene& scene);

// Returns a gradient for each of the scene's values, or null if it has none.
// The tangent plane at a corner is fitted to the variations along its edges, as [Bastos92] fig. 5 does for patches: by
// least squares, weighted by the inverse cubes of their lengths, so that parabolas along lines of unequal steps are
// reproduced. On the border of a surface, where edges leave to one side only, it is fitted to twice the variation less
// the slope of the gradient at the other end: the slope of the parabola, as on grids. If a gradient would leave the
// range of the values at the corner and its neighbours half an edge away, the excess is removed along that edge alone.
// Corners that do not share a value have gradients of their own.
const RadiosityGradient* set_gradients(const Scene& scene, Arena* keep, Arena* scratch);

}  // namespace pocketray
