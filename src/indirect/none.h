// No indirect light: surfaces not reached by any light are black.
#pragma once
#include "indirect/indirect.h"

namespace pocketray {

struct NoIndirect {
  static constexpr const char* kName = "none";
  static constexpr EffectMask kEffects = 0;
  static constexpr IndirectReference kReference = IndirectReference::nothing;
  static constexpr const char *kPresent = "", *kAbsent = "";
  static IndirectUse use(const Scene&) { return IndirectUse::nothing; }
  static IndirectNeed need(const Scene&, const Quality&) { return {}; }
  static const void* prepare(const Scene&, const Quality&, Arena*, Arena*) { return nullptr; }
  static Vec3 radiance(const IndirectPoint&) { return {0, 0, 0}; }
  static Vec3d exact(const Scene&, const Vec3d&) { return {0, 0, 0}; }
  static float bound(const Scene&, const Material&) { return 0; }
};

}  // namespace pocketray
