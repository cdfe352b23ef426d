// Light of single points: of points, spots, directions, and of lamps without a closed form.
#pragma once
#include "shade/lit_surface.h"

namespace pocketray {

// Samples light point i; `kept` is what its tile knows of it, or null. Returns false if no light arrives.
template <EffectMask mask>
[[gnu::always_inline]] inline bool sample_point(const Tracer& tracer, const LitSurface& to, const LightRun& run,
                                                std::uint32_t i, LightSample* sample, const TileSample** kept) {
  const FrameData& frame = *tracer.frame;
  *kept = nullptr;
  if (to.at_first_hit && is_sampled(tracer, i, kept)) {
    if (!*kept) return false;
    sample->direction = (*kept)->direction, sample->irradiance = (*kept)->irradiance;
  } else if (!lights_up(frame, to.surface, run, tracer.light_points[i], sample)) {
    return false;
  }
  return has(mask, Effect::shadow) || !is_below(to.surface, sample->direction);
}

// Adds the light of point i, which belongs to the run.
template <EffectMask mask>
[[gnu::always_inline]] inline void add_light_point(Tracer* tracer, const LitSurface& to, const LightRun& run,
                                                   std::uint32_t i, Vec3* sum) {
  LightSample sample;
  const TileSample* kept;
  if (!sample_point<mask>(*tracer, to, run, i, &sample, &kept)) return;
  const float cosine = dot(to.surface.normal, sample.direction);
  Vec3 light_out = reflected_light<mask>(*tracer->frame, to, sample.direction, sample.irradiance, cosine);
  if (is_negligible<mask>(tracer, to, light_out)) return;
  if constexpr (has(mask, Effect::shadow))
    light_out *= shadow<mask>(tracer, to.surface, run, i, kept ? nullptr : &sample, to.at_first_hit);
  *sum += light_out;
}

}  // namespace pocketray
