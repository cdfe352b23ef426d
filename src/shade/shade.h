// From a ray to radiance.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Picks the instantiation for the plan's mask. The function traces one camera ray: the radiance that arrives along it.
RadianceFunction find_radiance_function(EffectMask mask);

}  // namespace pocketray
