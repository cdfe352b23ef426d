// Linear light → display values, fast on a CPU without FPU: floats are compared as integers, and the sRGB curve is a
// table indexed by the exponent and the upper seven mantissa bits. Between 2⁻¹³ and 1 the 128 buckets of an octave are
// so narrow that each contains at most one threshold of an 8-bit level.
#pragma once
#include <cstdint>

#include "base/color.h"
#include "base/float_bits.h"

namespace pocketray {

// Numbers of radiance values that no display can show, per channel, after exposure.
struct ToneCounts {
  std::uint64_t nan = 0;       // shown as 0
  std::uint64_t infinite = 0;  // +Inf, shown as 1; -Inf is negative
  std::uint64_t negative = 0;  // shown as 0; -0 is not negative
};
inline ToneCounts& operator+=(ToneCounts& a, const ToneCounts& b) {
  a.nan += b.nan, a.infinite += b.infinite, a.negative += b.negative;
  return a;
}

constexpr int kToneOctaves = 13;
constexpr std::uint32_t kToneBucketCount = kToneOctaves * 128;
constexpr std::uint32_t kToneBitsMin = (127u - kToneOctaves) << 23;  // the bits of 2⁻¹³; below it every level is 0
constexpr std::uint32_t kToneBitsOne = 127u << 23;

struct ToneTables {
  std::uint8_t level[kToneBucketCount];      // 8-bit level at the lower edge of a bucket
  std::uint32_t threshold[257];              // smallest float, as bits, of each level; [256]: never reached
  std::uint16_t fine[kToneBucketCount + 1];  // 16-bit display value at the lower edge of a bucket
};
extern const ToneTables kToneTables;

// Returns whether a value outside [0, 1) is displayed as 1, not 0, and counts it. Not inlined, because it is rare.
bool tone_saturates(std::uint32_t bits, ToneCounts* counts);

// 8-bit sRGB level; equal to srgb_level() for every float.
inline std::uint8_t tone_level(float linear, ToneCounts* counts) {
  std::uint32_t bits = float_bits(linear);
  if (bits >= kToneBitsOne) return tone_saturates(bits, counts) ? 255 : 0;
  if (bits < kToneBitsMin) return 0;
  std::uint32_t level = kToneTables.level[(bits - kToneBitsMin) >> 16];
  return static_cast<std::uint8_t>(level + (bits >= kToneTables.threshold[level + 1]));
}

// 16-bit sRGB display value, 65535 for white: |error| ≤ 1, for dithering.
inline std::uint32_t tone_fine(float linear, ToneCounts* counts) {
  std::uint32_t bits = float_bits(linear);
  if (bits >= kToneBitsOne) return tone_saturates(bits, counts) ? 65535 : 0;
  if (bits < kToneBitsMin) return static_cast<std::uint32_t>(linear * (12.92f * 65535) + 0.5f);
  std::uint32_t bucket = (bits - kToneBitsMin) >> 16;
  std::uint32_t low = kToneTables.fine[bucket], high = kToneTables.fine[bucket + 1];
  return low + (((high - low) * (bits & 0xffff) + 0x8000) >> 16);
}

}  // namespace pocketray
