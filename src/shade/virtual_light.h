// A virtual light and its shadow ray.
#pragma once
#include "shade/surface.h"

namespace pocketray {

// A shadow ray ends a little before its light, which lies on a surface: by a fraction of its length.
constexpr float kVirtualRayEnd = 1 - 0x1p-10f;

// What a virtual light gives a surface if nothing is in the way of the ray; false if that is nothing.
inline bool arrives(const VirtualLight& from, float geometry_max, const Surface& s, const Vec3& origin, Vec3* light,
                    Ray* ray) {
  Vec3 to_light = {0, 0, 0};
  *light = virtual_irradiance(from, geometry_max, s.point, s.normal, &to_light);
  if (!(max_component(*light) > 0) || is_below(s, to_light)) return false;
  *ray = {origin, from.position - origin, kVirtualRayEnd};
  return true;
}

}  // namespace pocketray
