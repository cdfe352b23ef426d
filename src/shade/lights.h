// The light that each kind of light sends to a point.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// True if a point lies in the plane of an area light's point, to within rounding and 2^-9 of their distance.
inline bool is_in_plane(const LightPoint& light, const Vec3& p) {
  constexpr float kUneven = 0x1p-9f;  // chosen: so little hidden light is not visible
  const Vec3 offset = p - light.position;
  const float rounding = 0x1p-20f * max_component(max(abs(p), abs(light.position)));
  return std::fabs(dot(offset, light.direction)) <= kUneven * max_component(abs(offset)) + rounding;
}

// True if a triangle of the lamp's material lies in the plane of the light's point.
bool is_in_plane_of(const FrameData& frame, const LightPoint& light, std::uint32_t triangle);
// True if a triangle belongs to the flat piece of a lamp on which the light's point lies: its material, in its plane.
// It neither receives light from the point nor blocks it; other pieces of the lamp do both. Nearly all that are asked
// about are triangles on which the point lies, where shadow rays end, or have another material.
inline bool is_beside(const FrameData& frame, const LightPoint& light, std::uint32_t triangle) {
  if (frame.scene->triangles[triangle].material() != light.material) return false;
  return triangle - light.triangle < light.count || is_in_plane_of(frame, light, triangle);
}

// True if surfaces have stored light, which includes that of lamps on surfaces of their own material.
inline bool has_stored_light(const FrameData& frame) {
  return has(frame.mask, Effect::radiosity) && frame.scene->radiosity_info.count > 0;
}
// True if the surface has the light's material.
inline bool is_own(const FrameData& frame, const Surface& s, const LightPoint& light) {
  return light.material != kNone && &frame.scene->materials[light.material] == s.material;
}
// True if a surface of the light's material gets no light from it: it is in the same flat piece, or its stored light
// includes it.
bool is_unlit_by_own(const FrameData& frame, const Surface& s, const LightPoint& light);
// lights_up() for a surface of the light's material. A piece of an emitter does not light itself; another piece gets at
// most as much from each point as if the emitter surrounded it.
bool lights_up_own(const FrameData& frame, const Surface& s, const LightRun& run, const LightPoint& light,
                   LightSample* sample);

// Returns the light if its own surface must not block it, otherwise null.
inline const LightPoint* emitter_of(const LightPoint& light) { return light.material != kNone ? &light : nullptr; }

// Returns whether a light, if unblocked, contributes to the surface.
inline bool lights_up(const FrameData& frame, const Surface& s, const LightRun& run, const LightPoint& light,
                      LightSample* sample) {
  if (is_own(frame, s, light)) return lights_up_own(frame, s, run, light, sample);
  return run.sample(light, s.point, sample) && dot(s.normal, sample->direction) > 0;
}

LightSampler find_light_sampler(Effect kind);  // point_light, spot_light, directional_light or area_light

}  // namespace pocketray
