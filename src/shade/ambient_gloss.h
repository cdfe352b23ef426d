// Light that surfaces reflect from the surroundings, added to their emission: on glossy lobes from even surroundings
// (Effect::ambient_gloss), on diffuse and glossy lobes from an environment map or sky.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Sets the frame's functions for light from the surroundings. They stay null if the ambient term is all there is.
void find_surroundings(FrameData* frame);

// The radiance of even surroundings around a surface.
Vec3 even_surroundings(const FrameData& frame, const Surface& s);

// Wraps the surface functions in these, so that frames without surroundings do not even test for them.
void add_surroundings(FrameData* frame);

}  // namespace pocketray
