// First step of a solution: patches, and the light that they exchange.
#pragma once
#include "desktop/radiosity/surfaces.h"
#include "desktop/radiosity/transport.h"

namespace pocketray {

struct PatchSolution {
  explicit PatchSolution(const FrameData& frame) : rays{frame} {}
  PatchSolution(const PatchSolution&) = delete;  // the rays refer to the bodies
  std::vector<char> bodies;
  SceneRays rays;
  Surfaces surfaces;
  std::vector<Patch> patches;
  Exchange exchange;
};

// Calls `progress` with the share of this step.
Status solve_patches(const RadiosityOptions& options, const SolverProgress& progress, PatchSolution* solved);

}  // namespace pocketray
