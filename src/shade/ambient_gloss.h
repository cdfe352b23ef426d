// Light that surfaces reflect from the surroundings, added to their emission: on glossy lobes from even surroundings
// (Effect::ambient_gloss), on diffuse and glossy lobes from an environment map or sky.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Sets the frame's functions for light from the surroundings. They stay null if the ambient term is all there is.
void find_surroundings(FrameData* frame);

// The radiance of even surroundings around a surface.
Vec3 even_surroundings(const FrameData& frame, const Surface& s);

// True if the scene stores the light of the surroundings at each point.
bool stores_surroundings(const FrameData& frame);

// The environment's light on glossy lobes where radiosity is stored, which holds what arrives through openings and from
// walls: the share of the map's light, and light that comes evenly besides. Unscaled, the sky would shine through
// roofs.
struct IndoorLight {
  Vec3 share;
  Vec3 even;
};
// `irradiance` is environment_irradiance() at the surface.
IndoorLight indoor_light(const FrameData& frame, const Surface& s, const Vec3& irradiance);

// Wraps the surface functions in these, so that frames without surroundings do not even test for them.
void add_surroundings(FrameData* frame);

}  // namespace pocketray
