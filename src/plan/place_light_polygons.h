// Flat lamps as polygons, see shade/polygon_light.h.
#pragma once
#include "shade/frame_data.h"

namespace pocketray {

// Room for the polygons of a scene's lamps, one for each.
std::uint32_t light_polygon_count(const Scene& scene, EffectMask mask);
// Sets the polygons of the frame's area lights, which must be placed with the same `lamps`; none if light is to come from their points, or if
// no lamp has this form: flat, with an outline of few corners, and alike everywhere. `polygons` has room for all.
// Allocates nothing.
void place_light_polygons(Array<const Material> lamps, Array<LightPolygon> polygons, FrameData* frame);

}  // namespace pocketray
