// Reconstructs stored light as quadratics or cubics on triangles: of the mesh, and the halves of a grid's cells. Not
// inlined, so that kernels contain only a call.
#pragma once
#include "effect/settings.h"
#include "indirect/reconstruct/gradients.h"
#include "indirect/reconstruct/hermite.h"

namespace pocketray {

inline bool is_smooth_on_triangles(Reconstruction how) {
  return how == Reconstruction::quadratic || how == Reconstruction::cubic;
}

// Light in the half of a cell, divided along its diagonal from (0, 0) to (1, 1), that contains (s, t).
Vec3 smooth_cell(const PatchCorners& corners, float s, float t, Reconstruction how);

// Light in the part of a triangle that contains the barycentric place (1 − u − v, u, v); `place` is the reference of
// the triangle's side, not to a grid.
Vec3 smooth_part(const Scene& scene, const RadiosityGradient* gradients, const Triangle& triangle, std::uint32_t place,
                 float u, float v, Reconstruction how);

}  // namespace pocketray
