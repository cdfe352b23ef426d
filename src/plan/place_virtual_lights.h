// The virtual lights of a frame, see indirect/instant_radiosity.h.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Places as many as settings.virtual_lights, at most, by quasi-random walks from the frame's lights through diffuse
// surfaces, mirrors and glass [Keller97, sec. 3]. The walks are the same in every frame, so light changes only where
// something moves. The frame must be posed, accelerated and lit, and have its kernels.
void place_virtual_lights(FrameData* frame);

}  // namespace pocketray
