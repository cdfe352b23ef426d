#include "shade/polygon_light.h"

#include <algorithm>

#include "base/check.h"
#include "base/limits.h"
#include "effect/effect_probe.h"
#include "shade/form_factor.h"
#include "shade/polygon_share.h"

namespace pocketray {
namespace {

// Returns 2π times the form factor of the polygon with these corners, seen from the origin [Baum, Rushmeier, Winget
// 1989, eq. 7]. An edge that points at the origin adds nothing.
float edge_sum(const Vec3* corners, std::uint32_t count, const Vec3& normal) {
  float sum = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 &a = corners[i], &b = corners[i + 1 < count ? i + 1 : 0];
    const Vec3 across = cross(b, a);
    const float square = dot(across, across);
    if (square > 0) sum += angle_over_cross(square, dot(a, b)) * dot(across, normal);
  }
  return sum;
}

}  // namespace

PolygonView view_polygon(const LightPolygon& polygon, const Surface& s) {
  effect_entered<Effect::area_light>();
  PolygonView view = {false, false, 0, 0};
  Vec3 corners[kLightCornerMax];
  corners[0] = (polygon.corners[0] - s.point) * polygon.scale;
  if (!(dot(corners[0], corners[0]) <= kPolygonNear * kPolygonNear)) return view;
  view.is_near = true;
  float front = -dot(corners[0], polygon.normal);
  const bool from_behind = front < 0 && polygon.two_sided;
  if (from_behind) front = -front;
  if (!(front > 0)) return view;
  float lowest = dot(corners[0], s.normal), highest = lowest, lowest_above_triangle = dot(corners[0], s.geometric);
  for (std::uint32_t i = 1; i < polygon.corner_count; ++i) {
    corners[i] = (polygon.corners[i] - s.point) * polygon.scale;
    const float height = dot(corners[i], s.normal);
    lowest = std::min(lowest, height), highest = std::max(highest, height);
    lowest_above_triangle = std::min(lowest_above_triangle, dot(corners[i], s.geometric));
  }
  if (!(highest > 0)) return view;
  const Vec3 reach = abs(corners[0]);
  const float margin = (reach.x + reach.y + reach.z + 2) * polygon.margin;
  view.is_whole = std::min(std::min(lowest, lowest_above_triangle), front) > margin;
  float sum;
  if (lowest >= 0) {
    sum = edge_sum(corners, polygon.corner_count, s.normal);
  } else {
    Vec3 clipped[2 * kLightCornerMax];
    sum = edge_sum(clipped, clip_to_horizon(corners, polygon.corner_count, s.normal, clipped), s.normal);
    view.highest = highest;
  }
  const float form_factor = (from_behind ? -sum : sum) * (0.5f / kPiF);
  view.form_factor = form_factor > 0 ? std::min(form_factor, 1.0f) : 0;
  return view;
}

Vec3 polygon_irradiance(const LightPolygon& polygon, const PolygonView& view) {
  return min(polygon.radiance * (kPiF * view.form_factor), Vec3{kRadianceMax, kRadianceMax, kRadianceMax});
}

float lobe_share(const LightPolygon& polygon, const Surface& s, const LinearForm& form, const LobeParts& lobe) {
  effect_entered<Effect::area_light>();
  CHECK_LE(polygon.corner_count, kLightCornerMax);
  CHECK_EQ(form.power % 2, 1u);
  Vec3 corners[kLightCornerMax];
  for (std::uint32_t i = 0; i < polygon.corner_count; ++i) corners[i] = (polygon.corners[i] - s.point) * polygon.scale;
  return linear_share(lobe, form.power, corners, polygon.corner_count, s.normal);
}

}  // namespace pocketray
