// Light from the surroundings, added to the light that surfaces emit of themselves: on glossy lobes where it comes
// evenly from everywhere (Effect::ambient_gloss), on diffuse and glossy ones where it comes from an environment.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Sets the frame's functions for the plan; null: the surroundings light nothing, or only by the ambient term.
void find_surroundings(FrameData* frame);

// Puts the frame's functions in front of its surface functions, so that frames without one do not even test for it.
void add_surroundings(FrameData* frame);

}  // namespace pocketray
