// Lights as shading uses them, and a sample of one.
#pragma once
#include "base/vec3.h"

namespace pocketray {

// A light as shading uses it: a point, spot or directional light, or one of the points that represent an area light.
struct LightPoint {
  Vec3 position;
  Vec3 direction;  // spot, directional: direction of travel of the light; area: normal of the emitter
  Vec3 intensity;  // radiant intensity along `direction` (area) or everywhere (point, spot); directional: irradiance
  float range;     // 0: no limit
  float cos_inner, cos_outer;
  std::uint32_t material;   // lamp's material, see shade/lights.h for its own surfaces; other lights kNone
  std::uint32_t triangle;   // area: first of the triangles on which it lies, ...
  std::uint16_t count;      // ... one, or the two of a parallelogram
  std::uint16_t two_sided;  // area: emits on both sides
};

struct LightSample {
  Vec3 to_light;    // towards the light; a shadow ray runs along it, 0 < t < t_max
  Vec3 direction;   // unit vector of to_light
  Vec3 irradiance;  // on a surface facing the light
  float t_max;
};
// False if the light contributes nothing.
using LightSampler = bool (*)(const LightPoint& light, const Vec3& point, LightSample* sample);

}  // namespace pocketray
