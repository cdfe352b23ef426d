// A virtual light and its shadow ray.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// A shadow ray ends a little before its light, which lies on a surface: by a fraction of its length.
constexpr float kVirtualRayEnd = 1 - 0x1p-10f;

// What a virtual light gives a surface if nothing is in the way of the ray; false if that is nothing.
[[gnu::always_inline]] inline bool arrives(const VirtualLight& from, float geometry_max, const Surface& s,
                                           const Vec3& origin, Vec3* light, Ray* ray) {
  Vec3 to_light = {0, 0, 0};
  *light = virtual_irradiance(from, geometry_max, s.point, s.normal, &to_light);
  if (!(max_component(*light) > 0) || is_below(s, to_light)) return false;
  *ray = {origin, from.position - origin, kVirtualRayEnd};
  return true;
}

// Adds what the virtual lights give a surface that is no first hit. The rays to them are the tracer's, seen by its
// observer; they are fewer the smaller `weight`, the share of the surface's light that reaches the pixel.
void add_later_virtual_light(Tracer* tracer, const Vec3& weight, Surface* surface);

}  // namespace pocketray
