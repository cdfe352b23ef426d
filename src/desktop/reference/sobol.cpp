#include "desktop/reference/sobol.h"

namespace pocketray {
namespace {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x >> 16) | (x << 16);
  x = (x >> 8 & 0x00FF00FFu) | (x & 0x00FF00FFu) << 8;
  x = (x >> 4 & 0x0F0F0F0Fu) | (x & 0x0F0F0F0Fu) << 4;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

// Sum of direction numbers for each value of each four bits of an index, with bits reversed.
struct Table {
  std::uint32_t sum[8][16][kSobolDimensionCount] = {};
  constexpr Table() {
    constexpr int kDegree[kSobolDimensionCount] = {0, 1, 2,
                                                   3};  // of the primitive polynomial, with its inner coefficients,
    constexpr std::uint32_t kInner[kSobolDimensionCount] = {0, 0, 1, 1};
    constexpr std::uint32_t kFirst[kSobolDimensionCount][3] = {{1, 1, 1}, {1, 0, 0}, {1, 3, 0}, {1, 3, 1}};
    for (int d = 0; d < kSobolDimensionCount; ++d) {
      std::uint32_t direction[32] = {};
      int degree = kDegree[d];
      for (int i = 0; i < 32; ++i) {
        if (degree == 0 || i < degree) {
          direction[i] = (degree == 0 ? 1 : kFirst[d][i]) << (31 - i);
          continue;
        }
        direction[i] = direction[i - degree] ^ direction[i - degree] >> degree;
        for (int k = 1; k < degree; ++k)
          if (kInner[d] >> (degree - 1 - k) & 1) direction[i] ^= direction[i - k];
      }
      for (int part = 0; part < 8; ++part)
        for (int value = 0; value < 16; ++value)
          for (int b = 0; b < 4; ++b)
            if (value >> b & 1) sum[part][value][d] ^= reverse_bits(direction[4 * part + b]);
    }
  }
};
constexpr Table kTable;

// Returns the point with the bits of each coordinate reversed.
SobolPoint reversed_point(std::uint32_t index) {
  SobolPoint point = {};
  for (int part = 0; index; ++part, index >>= 4)
    for (int d = 0; d < kSobolDimensionCount; ++d) point.x[d] ^= kTable.sum[part][index & 15][d];
  return point;
}

// Flips each bit depending only on the lower ones [Laine & Karras 2011, "Stratified Sampling for Stochastic
// Transparency", sec. 3.1]; constants of [Burley 2020, listing 2].
std::uint32_t permute_upwards(std::uint32_t x, std::uint32_t seed) {
  x += seed;
  x ^= x * 0x6C50B47Cu;
  x ^= x * 0xB82F1E52u;
  x ^= x * 0xC7AFE638u;
  x ^= x * 0x8D22F6E6u;
  return x;
}

// Derives independent seeds from one: the finaliser of [Wellons 2018, "Prospecting for Hash Functions"].
std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7FEB352Du;
  x ^= x >> 15;
  x *= 0x846CA68Bu;
  return x ^ x >> 16;
}

}  // namespace

SobolPoint sobol_point(std::uint32_t index) {
  SobolPoint point = reversed_point(index);
  for (std::uint32_t& x : point.x) x = reverse_bits(x);
  return point;
}

SobolPoint scrambled_sobol_point(std::uint32_t index, std::uint32_t seed) {
  SobolPoint point = reversed_point(reverse_bits(permute_upwards(reverse_bits(index), hash(seed))));
  for (std::uint32_t d = 0; d < kSobolDimensionCount; ++d)
    point.x[d] = reverse_bits(permute_upwards(point.x[d], hash(seed + (d + 1) * 0x9E3779B9u)));
  return point;
}

}  // namespace pocketray
