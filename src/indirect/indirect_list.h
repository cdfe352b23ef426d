// One line per method of indirect light. --indirect auto selects the last one that the scene has by default.
#pragma once
#include "indirect/ambient.h"
#include "indirect/instant_radiosity.h"
#include "indirect/none.h"
#include "indirect/radiosity.h"

namespace pocketray {

using IndirectList = IndirectMethods<  //
    NoIndirect,                        //
    AmbientIndirect,                   //
    RadiosityIndirect,                 //
    InstantRadiosity                   //
    >;

static_assert(IndirectList::kEffects == kIndirectEffects, "each method of kIndirectEffects is in the list");

// Data that the methods read, in list order; null where a method is off or has none.
struct IndirectData {
  const void* prepared[IndirectList::kCount] = {};
};

// Methods to prepare: the plan's, and radiosity if later frames' settings may switch to it and then read
// gradients.
inline EffectMask prepared_methods(const Scene& scene, const Settings& settings, EffectMask mask) {
  const EffectMask radiosity = RadiosityIndirect::kEffects & ~settings.forced_off;
  const bool may_read_gradients =
      is_smooth_on_triangles(settings.reconstruction) && RadiosityIndirect::use(scene) != IndirectUse::nothing;
  return may_read_gradients ? mask | radiosity : mask;
}

// Total need of all these methods.
inline IndirectNeed indirect_need(const Scene& scene, const Quality& how, EffectMask mask) {
  IndirectNeed sum;
  for (const IndirectInfo& info : IndirectList::kInfos)
    if (mask & info.effects) {
      const IndirectNeed need = info.need(scene, how);
      sum.keep = size_sum(sum.keep, need.keep);
      if (need.scratch > sum.scratch) sum.scratch = need.scratch;
    }
  return sum;
}

inline IndirectData prepare_indirect(const Scene& scene, const Quality& how, EffectMask mask, Arena* keep,
                                     Arena* scratch) {
  IndirectData data;
  for (int i = 0; i < IndirectList::kCount; ++i)
    if (mask & IndirectList::kInfos[i].effects)
      data.prepared[i] = IndirectList::kInfos[i].prepare(scene, how, keep, scratch);
  return data;
}

// Lights of InstantRadiosity, placed anew for each frame; null if it is not prepared.
inline VirtualLights* virtual_lights_of(const IndirectData& data) {
  for (int i = 0; i < IndirectList::kCount; ++i)
    if (IndirectList::kInfos[i].effects == InstantRadiosity::kEffects)
      return static_cast<VirtualLights*>(const_cast<void*>(data.prepared[i]));  // in the renderer's arena
  return nullptr;
}

inline float indirect_bound(const Scene& scene, const Material& material, EffectMask mask) {
  float bound = 0;
  for (const IndirectInfo& info : IndirectList::kInfos)
    if (mask & info.effects) bound += info.bound(scene, material);
  return bound;
}

// For the renderer's own lighting, in double precision.
inline Vec3d exact_indirect_of(const Scene& scene, const Vec3d& diffuse, EffectMask mask) {
  Vec3d sum = {0, 0, 0};
  for (const IndirectInfo& info : IndirectList::kInfos)
    if (mask & info.effects) sum += info.exact(scene, diffuse);
  return sum;
}

// For the reference. `is_model`: for the lighting model, otherwise for light transport.
inline Vec3d exact_indirect(const Scene& scene, const Vec3d& diffuse, bool is_model) {
  Vec3d sum = {0, 0, 0};
  for (const IndirectInfo& info : IndirectList::kInfos)
    if (info.reference == IndirectReference::always || (is_model && info.reference == IndirectReference::model))
      sum += info.exact(scene, diffuse);
  return sum;
}

}  // namespace pocketray
