// Indirect light separate from the surface that reflects it, so that it can be rendered on another machine and at lower
// resolution: it is smooth where textures are not.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// Finds the surface that a camera ray shows: the first one not culled, starting at `hit`, the ray's first hit. Updates
// the ray, the hit and *passed, the distance to the last surface passed. Returns false if there is none.
bool visible_surface(Tracer* tracer, Ray* ray, Hit* hit, Surface* surface, float* passed);

// Returns whether a surface reflects indirect light: some albedo is left.
inline bool takes_indirect_light(const Surface& s) { return max_component(s.diffuse) > 0; }

// Radiance leaving the surface by the plan's method of indirect light, for an albedo of 1: irradiance / π. Tests all
// virtual lights for shadows.
Vec3 indirect_light(Tracer* tracer, const Surface& s);

// indirect_light() without virtual lights.
Vec3 stored_light(const FrameData& frame, const Surface& s);

// Stands for the light of a pixel that shows no surface reflecting it.
constexpr float kNoIndirectLight = -1;

// indirect_light() at a pixel's first sample, or kNoIndirectLight.
Vec3 pixel_indirect_light(Tracer* tracer, std::uint32_t column, std::uint32_t row);

}  // namespace pocketray
