// effect_entered<E>(): called on entry by every effect's code. Compiles to nothing in the product. The build that
// proves the plan (POCKETRAY_PROBE_EFFECTS) counts entries and traps if the plan says that the effect is absent.
#pragma once
#include "effect/effect.h"

#ifdef POCKETRAY_PROBE_EFFECTS
#include <atomic>
#include <cstdlib>
#endif

namespace pocketray {

#ifdef POCKETRAY_PROBE_EFFECTS
struct EffectProbe {
  std::atomic<EffectMask> allowed{kAllEffects};
  std::atomic<std::uint64_t> entries[kEffectCount];
};
inline EffectProbe effect_probe;  // zero-initialised; no constructor runs

template <Effect effect>
inline void effect_entered() {
  if (!has(effect_probe.allowed.load(std::memory_order_relaxed), effect)) std::abort();
  effect_probe.entries[static_cast<int>(effect)].fetch_add(1, std::memory_order_relaxed);
}
#else
template <Effect effect>
inline void effect_entered() {}
#endif

}  // namespace pocketray
