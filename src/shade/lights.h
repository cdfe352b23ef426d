// The light that each kind of light sends to a point.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// Whether a light, if unblocked, contributes anything to the surface. An emitter does not light itself.
inline bool lights_up(const FrameData& frame, const Surface& s, const LightRun& run, const LightPoint& light,
                      LightSample* sample) {
  if (light.material != kNone && &frame.scene->materials[light.material] == s.material) return false;
  return run.sample(light, s.point, sample) && dot(s.normal, sample->direction) > 0;
}

LightSampler find_light_sampler(Effect kind);  // point_light, spot_light, directional_light or area_light

}  // namespace pocketray
