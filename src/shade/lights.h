// How each kind of light reaches a point.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

LightSampler find_light_sampler(Effect kind);  // point_light, spot_light, directional_light or area_light

}  // namespace pocketray
