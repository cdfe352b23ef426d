// Adaptive shadow tests of area lights: rays where the penumbra is, few elsewhere [Kok & Jansen 1992, "Adaptive
// Sampling of Area Light Sources in Ray Tracing Including Diffuse Interreflection"]. The points of a light form groups,
// each divided in halves. Rays are traced to the corners and the middle of a group: if all are blocked or none is, so
// are its other points; otherwise each half is tested. A straight edge that crosses the light separates corners of each
// group it crosses, so that its penumbra is exact; something smaller may hide between the rays.
#pragma once
#include "base/arena.h"
#include "shade/lights.h"

namespace pocketray {

// Up to this many points of a light or a group are tested one by one.
constexpr std::uint32_t kUndividedMax = 5;
constexpr bool has_point_groups(const Settings& settings, EffectMask mask) {
  return has(mask, Effect::area_light) && settings.points_per_area_light > kUndividedMax;
}
inline std::size_t point_groups_need(std::uint32_t points) {
  return arena_need<PointGroup>(points) + 2 * arena_need<std::uint8_t>(points);
}

// Returns whether a point's shadow ray may decide for others: it leaves on the visible side of the triangle.
inline bool is_probe(const FrameData& frame, const Surface& s, const LightRun& run, const LightPoint& light,
                     LightSample* sample) {
  return lights_up(frame, s, run, light, sample) && dot(s.geometric, sample->direction) > 0;
}

// Returns whether something opaque blocks a point of an area light that lights up the surface. `light` is its index in
// Lights::points. Counts the rays traced.
bool is_point_blocked(Tracer* tracer, const Surface& s, std::uint32_t light, bool at_first_hit);

}  // namespace pocketray
