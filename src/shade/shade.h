// From a ray to radiance.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Selects the instance for the plan's mask. The function returns the radiance that arrives along a camera ray.
RadianceFunction find_radiance_function(EffectMask mask);

}  // namespace pocketray
