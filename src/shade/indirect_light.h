// Indirect light apart from the surface that reflects it, so that it can be rendered elsewhere, at fewer pixels: it is
// smooth where textures are not.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// The surface that a ray from the camera shows: the first that is not culled, from `hit`, its first hit. The ray, the
// hit and *passed, the distance to the last surface passed, follow it. False if there is none.
bool visible_surface(Tracer* tracer, Ray* ray, Hit* hit, Surface* surface, float* passed);

// Whether a surface reflects indirect light: some of its albedo is left.
inline bool takes_indirect_light(const Surface& s) { return max_component(s.diffuse) > 0; }

// Radiance that leaves the surface by the plan's method of indirect light, for an albedo of 1: irradiance / π. Virtual
// lights are all tested for shadows.
Vec3 indirect_light(Tracer* tracer, const Surface& s);

// In place of light where a pixel shows no surface that reflects it.
constexpr float kNoIndirectLight = -1;

// indirect_light() at a pixel's first sample, or kNoIndirectLight.
Vec3 pixel_indirect_light(Tracer* tracer, std::uint32_t column, std::uint32_t row);

}  // namespace pocketray
