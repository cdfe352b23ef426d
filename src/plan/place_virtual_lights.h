// The virtual lights of a frame, see indirect/instant_radiosity.h.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Places as many as settings.virtual_lights, at most, by quasi-random walks from the frame's lights through diffuse
// surfaces, mirrors and glass [Keller97, sec. 3]. The walks are the same in every frame: lights whose paths no moving
// object crosses are those of the last frame [Jevans92, sec. 6.4], bit for bit unless the scene outgrows its bounds.
// The frame must be posed, accelerated and lit, and have its kernels.
void place_virtual_lights(FrameData* frame);

}  // namespace pocketray
