// Points of the Sobol sequence in four dimensions, with hash-based Owen scrambling: evenly spread, individually
// uniform, and independent for different seeds.
#pragma once
#include <cstdint>

namespace pocketray {

constexpr int kSobolDimensionCount = 4;

struct SobolPoint {
  std::uint32_t x[kSobolDimensionCount];  // in units of 2⁻³²
};

// Point `index` of the sequence [Sobol 1967], direction numbers of [Joe & Kuo 2008, new-joe-kuo-6.21201].
SobolPoint sobol_point(std::uint32_t index);

// Point `index` of the sequence, shuffled and scrambled by the seed [Burley 2020, "Practical Hash-based Owen
// Scrambling", JCGT 9(4), listing 3]. Any 2ᵏ points that start at a multiple of 2ᵏ are spread as evenly as in the
// sequence itself.
SobolPoint scrambled_sobol_point(std::uint32_t index, std::uint32_t seed);

}  // namespace pocketray
