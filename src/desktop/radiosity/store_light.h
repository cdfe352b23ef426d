// Second step of a solution: light that arrives at the nodes of grids and at the corners of triangles.
#pragma once
#include "desktop/radiosity/solve_patches.h"

namespace pocketray {

// Light that leaves the patches. Emission reaches pixels as direct light, except those of its own material.
struct PatchLight {
  const std::vector<Patch>& patches;
  std::vector<Vec3d> all, reflected;
};
PatchLight light_of(const PatchSolution& solved);

// Returns the light arriving at a receiver of a material from all patches and from outside, as irradiance / π. Negative
// x: the receiver lies inside a body. `on_grid`: it is a node of a grid.
Vec3d gather(const SceneRays& rays, const PatchLight& light, const Receiver& at, std::uint32_t material, bool on_grid,
             std::uint32_t seed);

// Returns the light to store at a receiver, as gather() does.
using LightAt = std::function<Vec3d(const Receiver& at, std::uint32_t material, bool on_grid, std::uint32_t seed)>;

// Stores light on surfaces, those of the patches or the same divided otherwise. Calls `progress` with the share of this
// step.
Status store_light(const PatchSolution& solved, const Surfaces& surfaces, const RadiosityOptions& options,
                   const LightAt& light_at, const SolverProgress& progress, RadiositySolution* solution);

}  // namespace pocketray
