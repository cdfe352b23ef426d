// The virtual lights of a frame, see indirect/instant_radiosity.h.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Counts the lights that walks leave in a scene and measures its surfaces, once, before the first frame, so that both
// depend on the scene alone and not on settings or time. The frame must be posed and accelerated; `points` has room for
// a point of each light and is overwritten.
void measure_walks(const FrameData& frame, Array<const Light> scene_lights, Array<LightPoint> points);

// Places about settings.virtual_lights by quasi-random walks from the frame's lights through diffuse surfaces, mirrors
// and glass [Keller97, sec. 3]. The walks, and their number, are equal in every frame: lights whose paths no moving
// object crosses equal those of the last frame [Jevans92, sec. 6.4], bit for bit unless the scene outgrows its bounds.
// The frame must be posed, accelerated and lit, and have its kernels; call measure_walks() first.
void place_virtual_lights(FrameData* frame);

}  // namespace pocketray
