// Upper bounds of the radiance along rays, for the cut-off: emission, direct light at the smallest distance of every
// light from the geometry, and the most that interreflections at mirrors and glass can add.
#pragma once
#include "shade/cut_off.h"

namespace pocketray {

struct FrameData;
struct Scene;

// Bounds for any ray: the brightest of the surroundings, of surfaces that end a path, and of surfaces that mirror or
// transmit, each with its own share; rounded up by at most an eighth. Infinite if unbounded. Beyond settings.ray_depth,
// CutOff::beyond_depth or the environment is seen.
RadianceBounds radiance_bounds(const FrameData& frame);

// Returns whether paths branch: something transmits, or has a coat.
bool has_branches(const Scene& scene);

}  // namespace pocketray
