// The light that each kind of light sends to a point.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// Whether a point lies in the plane of an area light's point, to within rounding and 2^-9 of their distance.
inline bool is_in_plane(const LightPoint& light, const Vec3& p) {
  constexpr float kUneven = 0x1p-9f;  // chosen: what hides so little of a lamp's light is not seen
  const Vec3 offset = p - light.position;
  const float rounding = 0x1p-20f * max_component(max(abs(p), abs(light.position)));
  return std::fabs(dot(offset, light.direction)) <= kUneven * max_component(abs(offset)) + rounding;
}

// Whether a triangle is of the flat piece of a lamp that a point of it lies on: of its material and in its plane. It gets
// no light from the point and hides none of it; other pieces of the lamp do both.
inline bool is_beside(const FrameData& frame, const LightPoint& light, std::uint32_t triangle) {
  const Triangle& t = frame.scene->triangles[triangle];
  if (t.material() != light.material) return false;
  for (std::uint32_t v : t.vertices())
    if (!is_in_plane(light, frame.positions[v])) return false;
  return true;
}

// Whether surfaces have stored light, which includes that of lamps on surfaces of their own material.
inline bool has_stored_light(const FrameData& frame) {
  return has(frame.mask, Effect::radiosity) && frame.scene->radiosity_info.count > 0;
}
// Whether the surface is of the light's material, and whether it then gets none of its light: those of the same flat
// piece do not, and those with stored light have it there.
inline bool is_own(const FrameData& frame, const Surface& s, const LightPoint& light) {
  return light.material != kNone && &frame.scene->materials[light.material] == s.material;
}
inline bool is_unlit_by_own(const FrameData& frame, const Surface& s, const LightPoint& light) {
  return has_stored_light(frame) || is_beside(frame, light, s.hit.triangle);
}

// The light, if its own surface is not to hide it; otherwise null.
inline const LightPoint* emitter_of(const LightPoint& light) { return light.material != kNone ? &light : nullptr; }

// Whether a light, if unblocked, contributes anything to the surface. A piece of an emitter does not light itself;
// another one gets from no point of it more than if the emitter were all around.
inline bool lights_up(const FrameData& frame, const Surface& s, const LightRun& run, const LightPoint& light,
                      LightSample* sample) {
  const bool own = is_own(frame, s, light);
  if (own && is_unlit_by_own(frame, s, light)) return false;
  if (!run.sample(light, s.point, sample) || !(dot(s.normal, sample->direction) > 0)) return false;
  if (own) sample->irradiance = min(sample->irradiance, s.material->emission * kPiF);
  return true;
}

LightSampler find_light_sampler(Effect kind);  // point_light, spot_light, directional_light or area_light

}  // namespace pocketray
