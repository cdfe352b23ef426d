// Light that passes a thin surface diffusely, as through a leaf or a lampshade (Effect::diffuse_transmission; glTF's
// KHR_materials_diffuse_transmission): seen from the viewer's side, it is light that a matte surface on the other side
// of the triangle receives. Of light from either side, a boundary of reflectance F reflects its share first, so that no
// more leaves the surface than arrives.
#pragma once
#include "scene/diffuse_transmission.h"
#include "shade/surface.h"

namespace pocketray {

// Dims the diffuse lobe by what passes instead. The surface's other lobes need not be set.
void dim_by_passing(const FrameData& frame, Surface* s);

// Returns whether light passes the surface, whose lobes at the point are `lobes`, towards the viewer; sets the matte
// surface that receives this light, with the glow of stored and unshadowed light. `ray` comes from the viewer.
bool find_other_side(const FrameData& frame, const Ray& ray, const Surface& s, const Material& lobes, Surface* other);

}  // namespace pocketray
