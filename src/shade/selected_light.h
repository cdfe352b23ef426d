// Direct light by source selection, see source_selection.h.
#pragma once
#include "shade/shadow.h"
#include "shade/source_selection.h"
#include "shade/tracer.h"

namespace pocketray {

// Direct light with source selection; arguments as for direct_light().
template <EffectMask mask>
Vec3 selected_light(Tracer* tracer, const Surface& s, const Material& m, const Vec3& to_viewer, const Vec3& weight) {
  effect_entered<Effect::source_selection>();
  const FrameData& frame = *tracer->frame;
  const bool at_first_hit = tracer->first_surface && same_surface(*tracer->first_surface, s);
  const bool casts_shadows = has(frame.mask, Effect::shadow);
  const float tolerance = frame.settings.light_tolerance, glow = max_component(s.glow), most = max_component(weight);
  SourceSearch search(tracer, s, m, to_viewer);
  Vec3 seen = {0, 0, 0}, tested = {0, 0, 0};
  while (!search.is_empty()) {
    const double rest = search.remaining();
    if (rest <= static_cast<double>(tolerance * (max_component(seen) + glow))) break;
    const double unseen = rest * static_cast<double>(most);
    if (unseen <= static_cast<double>(tracer->budget) && leave_out(tracer, static_cast<float>(unseen))) break;
    LightEntry entry;
    if (!search.take(&entry)) continue;
    tested += entry.radiance;
    if (!casts_shadows) {
      seen += entry.radiance;
      continue;
    }
    const LightRun& run = frame.lights.runs[entry.run];
    if (at_first_hit) trace_selected(tracer, run, entry.light);
    seen += entry.radiance * shadow<mask>(tracer, s, run, entry.light, nullptr, at_first_hit);
  }
  const float all = max_component(tested);
  // If nothing was tested, assumes the middle of the interval.
  const float visibility = all > 0 ? max_component(seen) / all : 0.5f;
  return search.is_empty() ? seen : seen + search.estimate() * visibility;
}

}  // namespace pocketray
