// PCG32: small, seedable, the same on every CPU [O'Neill 2014, sec. 6.3, PCG-XSH-RR].
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

struct Rng {
  std::uint64_t state = 0, increment = 1;
};

inline std::uint32_t next_u32(Rng* rng) {
  std::uint64_t old = rng->state;
  rng->state = old * 6364136223846793005ull + rng->increment;
  std::uint32_t xorshifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
  std::uint32_t rotation = static_cast<std::uint32_t>(old >> 59);
  return (xorshifted >> rotation) | (xorshifted << ((32 - rotation) & 31));
}
inline Rng make_rng(std::uint64_t seed, std::uint64_t stream = 0) {
  Rng rng{0, (stream << 1) | 1};
  next_u32(&rng);
  rng.state += seed;
  next_u32(&rng);
  return rng;
}
// Uniform in [0, 1), with 24 bits.
inline float next_float(Rng* rng) { return static_cast<float>(next_u32(rng) >> 8) * 0x1p-24f; }
inline double next_double(Rng* rng) {
  std::uint64_t high = next_u32(rng) >> 5, low = next_u32(rng) >> 6;
  return static_cast<double>(high * 67108864u + low) * 0x1p-53;
}

}  // namespace pocketray
