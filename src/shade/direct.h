// Direct light at a surface: lights × shadow rays.
#pragma once
#include "brdf/brdf_list.h"
#include "shade/shadow.h"

namespace pocketray {

// Radiance towards the viewer from light that arrives straight from the lights; `m` has the lobes there. `weight` is
// the throughput of the path so far.
template <EffectMask mask>
Vec3 direct_light(Tracer* tracer, const Surface& s, const Material& m, const Vec3& to_viewer, const Vec3& weight) {
  const FrameData& frame = *tracer->frame;
  Vec3 diffuse = s.diffuse * (1 / kPiF);
  Vec3 sum = {0, 0, 0};
  const bool at_first_hit = tracer->first_surface && same_surface(*tracer->first_surface, s);
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LightPoint& light = frame.lights[i];
      LightSample sample;
      const TileSample* kept = nullptr;
      if (at_first_hit && is_sampled(*tracer, i, &kept)) {
        if (!kept) continue;
        sample.direction = kept->direction, sample.irradiance = kept->irradiance;
      } else if (!lights_up(frame, s, run, light, &sample)) {
        continue;
      }
      float cosine = dot(s.normal, sample.direction);
      if (!has(mask, Effect::shadow) && is_below(s, sample.direction)) continue;
      Vec3 f = diffuse;
      if constexpr (has(mask, Effect::specular)) {
        if (!is_zero(m.specular)) {
          effect_entered<Effect::specular>();
          Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
          const BrdfInfo* lobe = kBrdfList[m.brdf];
          if constexpr (has(mask, Effect::metallic_roughness)) lobe = &lobe_at(frame, s, m);
          f = lobe->value(m, specular, diffuse, s, to_viewer, sample.direction);
        }
      }
      Vec3 light_out = f * sample.irradiance * cosine;
      float bound = max_component(light_out * weight);
      if (!(bound > 0)) continue;
      if constexpr (has(mask, Effect::shadow)) {
        if (leave_out(tracer, bound)) continue;
        auto find_ray = [&] {
          if (kept) run.sample(light, s.point, &sample);
          return shadow_ray(frame, s, sample);
        };
        light_out *= shadow<mask>(tracer, s, find_ray, i, at_first_hit);
      }
      sum += light_out;
    }
  }
  return sum;
}

}  // namespace pocketray
