// Floats by their bits, which sort like magnitudes.
#pragma once
#include <cstdint>
#include <cstring>
#include <limits>

namespace pocketray {

static_assert(std::numeric_limits<float>::is_iec559 && sizeof(float) == sizeof(std::uint32_t), "bits as in IEEE 754");

inline std::uint32_t float_bits(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
// Bits of |value|; above kInfinityBits for a NaN.
inline std::uint32_t magnitude_bits(float value) { return float_bits(value) & 0x7FFFFFFFu; }
constexpr std::uint32_t kInfinityBits = 0x7F800000u;

}  // namespace pocketray
