// Instantiates a part of the kernel for every combination of the effects on which it depends; the plan's is selected
// once per frame.
#pragma once
#include <cstddef>
#include <utility>

#include "effect/effect.h"

namespace pocketray {

constexpr std::size_t effect_count(EffectMask mask) {
  std::size_t n = 0;
  for (; mask; mask &= mask - 1) ++n;
  return n;
}

// Effects of a mask as an array.
template <EffectMask mask>
struct EffectsOf {
  Effect effects[effect_count(mask)] = {};
  constexpr EffectsOf() {
    std::size_t n = 0;
    for (int i = 0; i < kEffectCount; ++i)
      if (has(mask, static_cast<Effect>(i))) effects[n++] = static_cast<Effect>(i);
  }
  constexpr const Effect& operator[](std::size_t i) const { return effects[i]; }
};

// Part has Function, kEffects (an array of Effect) and instance<mask>(), the function for a mask of those effects.
template <class Part>
struct Instantiations {
  using Function = typename Part::Function;
  static constexpr std::size_t kEffectsOfPart = sizeof Part::kEffects / sizeof Part::kEffects[0];

  static constexpr EffectMask mask_of(std::size_t index) {
    EffectMask mask = 0;
    for (std::size_t i = 0; i < kEffectsOfPart; ++i)
      if (index >> i & 1) mask |= bit(Part::kEffects[i]);
    return mask;
  }
  template <std::size_t... index>
  static Function pick(std::size_t wanted, std::index_sequence<index...>) {
    static constexpr Function table[] = {Part::template instance<mask_of(index)>()...};
    return table[wanted];
  }
  static Function find(EffectMask mask) {
    std::size_t index = 0;
    for (std::size_t i = 0; i < kEffectsOfPart; ++i)
      if (has(mask, Part::kEffects[i])) index |= std::size_t(1) << i;
    return pick(index, std::make_index_sequence<std::size_t(1) << kEffectsOfPart>());
  }
};

}  // namespace pocketray
