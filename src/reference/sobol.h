// Points of the Sobol sequence in four dimensions, each set scrambled after Owen by a hash: evenly spread, uniform each
// by itself, and sets of different seeds independent of one another.
#pragma once
#include <cstdint>

namespace pocketray {

constexpr int kSobolDimensionCount = 4;

struct SobolPoint {
  std::uint32_t x[kSobolDimensionCount];  // in units of 2⁻³²
};

// Point `index` of the sequence [Sobol 1967], direction numbers of [Joe & Kuo 2008, new-joe-kuo-6.21201].
SobolPoint sobol_point(std::uint32_t index);

// Point `index` of the sequence, in an order and with a scrambling that the seed chooses [Burley 2020, "Practical
// Hash-based Owen Scrambling", JCGT 9(4), listing 3]. Any 2ᵏ points from a multiple of 2ᵏ on are spread as evenly as
// those of the sequence itself.
SobolPoint scrambled_sobol_point(std::uint32_t index, std::uint32_t seed);

}  // namespace pocketray
