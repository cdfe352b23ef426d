// Lights as trace_spans uses them: sorted by kind, area lights represented by points [Aranha07] sec. 3.1.
#pragma once
#include "base/status.h"
#include "shade/frame_data.h"

namespace pocketray {

// Counts the scene's LightPoints for the effects of the mask; fails above kPointLightCountMax.
Status light_point_count(const Scene& scene, const Settings& settings, EffectMask mask, std::uint32_t* count);

// Fills `points` (light_point_count() of them) from posed lights and frame->geometry.positions, and sets the frame's
// lights and runs for the effects of its mask. Materials that emit in `lamps` are area lights, as when they were
// counted, however dim they are now. Allocates nothing.
void place_lights(Array<const Light> lights, Array<const Material> lamps, Array<LightPoint> points, FrameData* frame);
// After place_lights(), sets Lights::sample_points, for which there is room in `points`: the frame's other lights, and
// other points of the same area lights. Allocates nothing.
void place_sample_points(Array<const Material> lamps, Array<LightPoint> points, FrameData* frame);

}  // namespace pocketray
