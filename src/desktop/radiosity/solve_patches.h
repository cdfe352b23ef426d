// First steps of a solution: patches, and the light that they exchange.
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
  std::vector<Outlook> looks;  // of each patch
  Exchange exchange;
};

Status divide_surfaces(const RadiosityOptions& options, PatchSolution* solved);
// Calls `progress` with the share of this step. Form factors take 4 bytes for each pair of patches.
Status exchange_light(const RadiosityOptions& options, const SolverProgress& progress, PatchSolution* solved);

}  // namespace pocketray
