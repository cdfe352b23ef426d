// Surfaces that stand on others, such as partitions, and the light on either side of them.
#pragma once
#include "radiosity/receivers.h"

namespace pocketray {

// Values are interpolated between the nodes of a grid, also across what stands between them. Where a node has much more
// light than a neighbour that it does not see, it takes that one's: what is lost is less than what would shine through
// the other side. `known`: nodes that do not lie inside bodies.
void keep_behind_barriers(const SceneRays& rays, const std::vector<NodePlace>& places, const std::vector<char>& known,
                          RadiositySolution* solution);

}  // namespace pocketray
