// Flat lamps whose light is known in closed form.
#pragma once
#include "base/limits.h"
#include "base/vec3.h"

namespace pocketray {

// A flat lamp of uniform radiance, see polygon_light.h.
struct LightPolygon {
  Vec3 corners[kLightCornerMax];  // counter-clockwise seen from its front
  std::uint32_t corner_count;     // 0: the lamp is not such a polygon, nothing else is set
  std::uint32_t two_sided;
  Vec3 normal, radiance;
  float scale;   // a power of two; the polygon's size times it is 1/2 to 1
  float margin;  // sine of a margin that covers the rounding of its corners and of the lamp's points
};

}  // namespace pocketray
