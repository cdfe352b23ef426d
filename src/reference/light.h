// Light that the reference fetches from the lights themselves: next-event estimation.
#pragma once
#include "reference/optics.h"

namespace pocketray {

// Triangles of a frame that `power` (per area, of a material) is above zero for, into an array with room for all, each
// with its share of the power; returns their number.
std::uint32_t find_parts(const FrameData& frame, double (*power)(const Material& material), ReferenceEmitter* parts);
// A point of them, uniform in power, for a pair that is uniform in [0, 1)².
struct ReferencePlace {
  std::uint32_t triangle;
  double u, v;
  Vec3d point;
};
ReferencePlace pick_place(const FrameData& frame, const Array<ReferenceEmitter>& parts, const Pair& pair);

// The power of a light, for find_parts().
double emitted_power(const Material& m);
// Density per area with which an emitter is picked.
double emitter_density(const Reference& reference, std::uint32_t triangle);

// Radiance towards the viewer by light straight from the frame's lights that are points, spots and directions, and from
// the points that stand for area lights where those are asked for.
Vec3d sum_light_points(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer,
                       bool with_area_lights);

// Radiance towards the viewer by light straight from the lights, one sample of it. Of area lights it is the part that
// the heuristic of multiple importance sampling leaves to them where light is followed through the scene and the path
// goes on.
Vec3d sample_direct_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                          const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples);

// Veach's power heuristic, exponent 2 [Veach 1997, eq. 9.13].
inline double power_heuristic(double density, double other) {
  double a = density * density, b = other * other;
  return a > 0 ? a / (a + b) : 0;
}

}  // namespace pocketray
