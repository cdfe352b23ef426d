// Groups of lights for source selection, see shade/source_selection.h.
#pragma once
#include "shade/light_tree.h"

namespace pocketray {

struct FrameData;

// Sets frame->lights.tree: a tree for each kind of lights that have positions, split at the median of the longest side
// of their box [Walter05, "Lightcuts", joins pairs instead]. `nodes` and `order` have at least as many elements as the
// frame has lights, which must be placed. Allocates nothing.
void place_light_tree(Array<LightNode> nodes, Array<std::uint32_t> order, FrameData* frame);

}  // namespace pocketray
