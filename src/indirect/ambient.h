// The ambient term: uniform radiance from everywhere, reflected by a diffuse surface according to its albedo.
#pragma once
#include "effect/effect_probe.h"
#include "indirect/indirect.h"

namespace pocketray {

struct AmbientIndirect {
  static constexpr const char* kName = "ambient";
  static constexpr EffectMask kEffects = bit(Effect::ambient);
  static constexpr IndirectReference kReference = IndirectReference::model;
  static constexpr const char *kPresent = "constant indirect light", *kAbsent = "no constant indirect light";
  static IndirectUse use(const Scene& scene) {
    return is_zero(scene.info.ambient) ? IndirectUse::nothing : IndirectUse::automatic;
  }
  static IndirectNeed need(const Scene&, const Quality&) { return {}; }
  static const void* prepare(const Scene&, const Quality&, Arena*, Arena*) { return nullptr; }
  static Vec3 radiance(const IndirectPoint& at) {
    effect_entered<Effect::ambient>();
    return at.diffuse * at.scene.info.ambient;
  }
  static Vec3d exact(const Scene& scene, const Vec3d& diffuse) { return diffuse * to_double(scene.info.ambient); }
  static float bound(const Scene& scene, const Material& material) {
    return max_component(material.diffuse * scene.info.ambient);
  }
};

}  // namespace pocketray
