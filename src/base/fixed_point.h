// Floats as integers with a common scale, for CPUs without floating point. A fixed-point number counts units of
// 2^-28 of the power of two above all coordinates, so coordinates have magnitudes below 2^28, differences below 2^29.
#pragma once
#include "base/float_bits.h"

namespace pocketray {

// A scale's exponent is the biased exponent of the largest coordinate. Below this, denormals would matter.
constexpr int kFixedExponentMin = 32;
constexpr std::int32_t kFixedMax = (1 << 29) - 1;

// value · 2^shift in units, cut towards zero, where shift makes 2^(exponent − 126) equal 2^28. Magnitudes from 2^29 on,
// infinity and NaN become ±kFixedMax.
inline std::int32_t to_fixed(float value, int exponent) {
  std::uint32_t bits = float_bits(value), size = bits << 8 | 1u << 31;
  int shift = exponent + 4 - static_cast<int>(bits >> 23 & 255);
  size = shift > 31 ? 0 : shift < 3 ? static_cast<std::uint32_t>(kFixedMax) : size >> shift;
  return bits >> 31 ? -static_cast<std::int32_t>(size) : static_cast<std::int32_t>(size);
}

// A number between −1 and 1 in units of 2^-31, cut towards zero; ±1 becomes ±(1 − 2^-31).
inline std::int32_t to_fraction(float value) {
  std::uint32_t bits = float_bits(value), size = bits << 8 | 1u << 31;
  int shift = 127 - static_cast<int>(bits >> 23 & 255);
  size = shift > 31 ? 0 : shift < 1 ? 0x7FFFFFFFu : size >> shift;
  return bits >> 31 ? -static_cast<std::int32_t>(size) : static_cast<std::int32_t>(size);
}

inline std::uint32_t magnitude(std::int32_t a) {
  const std::uint32_t bits = static_cast<std::uint32_t>(a);
  return a < 0 ? 0 - bits : bits;
}
inline std::int64_t product(std::int32_t a, std::int32_t b) { return static_cast<std::int64_t>(a) * b; }
// value · fraction; too low by less than 2.
inline std::int32_t part(std::int32_t value, std::int32_t fraction) {
  return 2 * static_cast<std::int32_t>(product(value, fraction) >> 32);
}

}  // namespace pocketray
