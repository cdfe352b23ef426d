// A part of the kernel, instantiated for every combination of the effects it knows; the plan's is picked once per
// frame.
#pragma once
#include <cstddef>
#include <utility>

#include "effect/effect.h"

namespace pocketray {

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
