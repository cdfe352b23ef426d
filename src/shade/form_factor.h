// Form factor of a polygon at a point: the cosine-weighted share of the hemisphere that it fills. Corners are relative
// to the point.
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

// Clips a polygon to the half-space above the horizon [Sutherland & Hodgman 1974]; `clipped` has room for twice as many
// corners. Returns their number. If the polygon is not convex, edges joining its parts run both ways and cancel.
template <class T>
std::uint32_t clip_to_horizon(const Vec3T<T>* corners, std::uint32_t count, const Vec3T<T>& normal, Vec3T<T>* clipped) {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3T<T>&a = corners[i], &b = corners[i + 1 < count ? i + 1 : 0];
    const T above_a = dot(a, normal), above_b = dot(b, normal);
    if (above_a >= 0) clipped[kept++] = a;
    if ((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0))
      clipped[kept++] = a + (b - a) * (above_a / (above_a - above_b));
  }
  return kept;
}

// Form factor of a polygon above the horizon, counter-clockwise as seen from the point, by Lambert's formula [Baum,
// Rushmeier, Winget 1989, eq. 7]. Negative if it is clockwise.
double form_factor_above_horizon(const Vec3d* corners, std::uint32_t count, const Vec3d& normal);

}  // namespace pocketray
