#include "plan/effects/unobstructed.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

// Chosen: rooms have a dozen triangles, and a plan should take no time that anyone notices on a CPU without an FPU.
constexpr std::uint32_t kTriangleMax = 128;
// Vertices may be off a plane by the rounding of their coordinates along its normal, less than rays begin above it
// (origin_offset() of shade/surface.h). Lights must be off it by much more, relative to the largest coordinate.
constexpr double kVertexRounding = 0x1p-23, kLightMargin = 0x1p-10;
constexpr double kNeedle = 0x1p-6;  // height over length

struct Plane {
  Vec3d point, normal;  // unit
};

struct Height {
  double value;
  bool is_zero;  // to the rounding of coordinates
};
Height height_over(const Plane& plane, const Vec3& point) {
  const Vec3d p = to_double(point);
  double height = 0, size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    height += plane.normal[axis] * (p[axis] - plane.point[axis]);
    size += std::fabs(plane.normal[axis]) * (std::fabs(p[axis]) + std::fabs(plane.point[axis]));
  }
  return {height, std::fabs(height) <= kVertexRounding * size};
}

double largest_coordinate(const Scene& scene) {
  double largest = 0;
  auto include = [&](const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::fabs(static_cast<double>(p[axis])));
  };
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) include(scene.positions[v]);
  for (const Light& light : scene.lights)
    if (light.kind != LightKind::directional) include(light.position);
  return largest;
}

// The side of the plane on which all vertices lie: +1, −1, or 0 if all lie on it. Returns false if they lie on both.
bool find_side(const Scene& scene, const Plane& plane, int* side) {
  CHECK(side != nullptr);
  *side = 0;
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) {
      const Height height = height_over(plane, scene.positions[v]);
      if (height.is_zero) continue;
      const int here = height.value > 0 ? 1 : -1;
      if (*side == -here) return false;
      *side = here;
    }
  return true;
}

// Returns whether the lamp is flush with the plane, or nowhere near it.
bool is_lamp_clear(const Scene& scene, const Plane& plane, const Triangle& lamp, double margin) {
  CHECK_GE(margin, 0);
  int flush = 0;
  for (std::uint32_t v : lamp.vertices()) {
    const Height height = height_over(plane, scene.positions[v]);
    if (height.is_zero)
      ++flush;
    else if (!(std::fabs(height.value) > margin))
      return false;
  }
  return flush == 0 || flush == 3;
}

bool has_lights_on_side(const Scene& scene, const Plane& plane, double margin, int side) {
  CHECK(side >= -1 && side <= 1);
  for (const Light& light : scene.lights) {
    const bool is_distant = light.kind == LightKind::directional;
    const double height = is_distant ? -dot(plane.normal, to_double(light.direction))
                                     : dot(plane.normal, to_double(light.position) - plane.point);
    if (!(std::fabs(height) > (is_distant ? kLightMargin : margin))) return false;
    if (side != 0 && (height > 0) != (side > 0)) return false;
  }
  for (const Triangle& t : scene.triangles)
    if (!is_zero(scene.materials[t.material()].emission) && !is_lamp_clear(scene, plane, t, margin)) return false;
  return true;
}

}  // namespace

bool is_unobstructed(const Scene& scene) {
  if (scene.triangles.empty() || scene.triangles.count > kTriangleMax || scene.moving_meshes.count > 0) return false;
  for (const Light& light : scene.lights)
    if (light.node != kNone) return false;
  const double largest = largest_coordinate(scene);
  CHECK(std::isfinite(largest));
  for (const Triangle& t : scene.triangles) {
    const Vec3d a = to_double(scene.positions[t.vertex(0)]), ab = to_double(scene.positions[t.vertex(1)]) - a,
                ac = to_double(scene.positions[t.vertex(2)]) - a;
    const Vec3d perpendicular = cross(ab, ac);
    if (is_zero(perpendicular)) continue;  // cannot be hit
    const double area = length(perpendicular), longest = std::max({dot(ab, ab), dot(ac, ac), dot(ac - ab, ac - ab)});
    if (!(area > kNeedle * longest)) return false;
    CHECK_LT(t.material(), scene.materials.count);
    const Plane plane = {a, perpendicular / area};
    int side;
    if (!find_side(scene, plane, &side)) return false;
    if (!has_lights_on_side(scene, plane, kLightMargin * largest, side)) return false;
  }
  return true;
}

}  // namespace pocketray
