// Flat lamps as polygons, see shade/polygon_light.h.
#pragma once
#include "effect/effect.h"
#include "scene/scene.h"
#include "shade/light_polygon.h"

namespace pocketray {

struct FrameData;

// Number of polygons to reserve for a scene's lamps, one for each.
std::uint32_t light_polygon_count(const Scene& scene, EffectMask mask);
// Sets the polygons of the frame's area lights, which must be placed with the same `lamps`. Sets none if light comes
// from their points, or if no lamp is flat and uniform with an outline of few corners, unless samples see few of their
// points. `polygons` has room for all. Allocates nothing.
void place_light_polygons(Array<const Material> lamps, Array<LightPolygon> polygons, FrameData* frame);

}  // namespace pocketray
