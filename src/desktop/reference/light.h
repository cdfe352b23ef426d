// Next-event estimation: light sampled from the lights themselves.
#pragma once
#include "desktop/reference/optics.h"

namespace pocketray {

// Writes the triangles of a frame with `power` (per area, of a material) above zero to an array with room for all, each
// with its share of the power; returns their number.
std::uint32_t find_parts(const FrameData& frame, double (*power)(const Material& material), ReferenceEmitter* parts);
// A point on these triangles, uniform in power, from a pair uniform in [0, 1)².
struct ReferencePlace {
  std::uint32_t triangle;
  double u, v;
  Vec3d point;
};
ReferencePlace pick_place(const FrameData& frame, const Array<ReferenceEmitter>& parts, const Pair& pair);

// Power of an emitter, for find_parts().
double emitted_power(const Material& m);
// Density per area of picking a point on an emitter.
double emitter_density(const Reference& reference, std::uint32_t triangle);

// Radiance towards the viewer, directly from the frame's point, spot and directional lights and, on request, from the
// points that represent area lights and the sun that the environment shows.
Vec3d sum_light_points(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer,
                       bool with_area_lights, bool with_shown_sun);

// One sample of the radiance towards the viewer that comes directly from the lights. In full light transport, if the
// path continues, area lights get their share by multiple importance sampling.
Vec3d sample_direct_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                          const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples);

// Fraction of light that arrives along a ray, without refraction.
Vec3d transmittance(const ReferenceWorld& world, const ReferenceRay& ray, const ShadowRules& rules);

// Veach's power heuristic, exponent 2 [Veach 1997, eq. 9.13].
inline double power_heuristic(double density, double other) {
  double a = density * density, b = other * other;
  return a > 0 ? a / (a + b) : 0;
}

}  // namespace pocketray
