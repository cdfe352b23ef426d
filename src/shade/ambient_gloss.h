// Glossy lobes lit by the surroundings (Effect::ambient_gloss), added to the light that surfaces emit of themselves.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// This light at the surface that the ray met, for the material's lobes there.
Vec3 glow_of_surroundings(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s);

// Puts the effect in front of the frame's surface functions, so that frames without it do not even test for it.
void add_ambient_gloss(FrameData* frame);

}  // namespace pocketray
