// A virtual light and its shadow ray.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// A shadow ray ends a little before its light, which lies on a surface: by a fraction of its length.
constexpr float kVirtualRayEnd = 1 - 0x1p-10f;

// Unblocked light from a virtual light at a surface; returns false if there is none.
[[gnu::always_inline]] inline bool arrives(const VirtualLight& from, float geometry_max, const Surface& s,
                                           Vec3* light) {
  Vec3 to_light = {0, 0, 0};
  *light = virtual_irradiance(from, geometry_max, s.point, s.normal, &to_light);
  return max_component(*light) > 0 && !is_below(s, to_light);
}
// Shadow ray to it from the surface's safe origin.
inline Ray ray_to(const VirtualLight& light, const Surface& s, const Vec3& origin) {
  return {origin, light.position - origin, kVirtualRayEnd, s.hit.triangle, light.triangle};
}

// Adds the light of virtual lights at a secondary hit. The tracer counts and observes the rays; the smaller `weight`,
// the share of the surface's light that reaches the pixel, the fewer there are.
void add_later_virtual_light(Tracer* tracer, const Vec3& weight, Surface* surface);

}  // namespace pocketray
