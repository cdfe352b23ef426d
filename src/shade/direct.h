// Direct light at a surface: of each run of lights, choose those that can reach it, sample them, evaluate the surface's
// lobes, find what is visible, and add it up.
#pragma once
#include "shade/lamp_light.h"
#include "shade/light_points.h"

namespace pocketray {

// Radiance towards the viewer from light that arrives directly from the lights; `m` has the lobes at the point.
// `weight` is the throughput of the path so far.
template <EffectMask mask>
Vec3 direct_light(Tracer* tracer, const Surface& s, const Material& m, const Vec3& to_viewer, const Vec3& weight) {
  const FrameData& frame = *tracer->frame;
  Vec3 sum = {0, 0, 0};
  const bool at_first_hit = tracer->first_surface && same_surface(*tracer->first_surface, s);
  const LitSurface to = {s, m, to_viewer, weight, diffuse_value<mask>(s), at_first_hit};
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    if (run.polygons) {
      const LitSurface copy = to;  // arguments passed by reference must live in memory
      sum = add_area_lights<mask & kDirectEffects>(tracer, copy, run, sum);
      continue;
    }
    for (std::uint32_t i = run.begin; i < run.end; ++i) add_light_point<mask>(tracer, to, run, i, &sum);
  }
  return sum;
}

}  // namespace pocketray
