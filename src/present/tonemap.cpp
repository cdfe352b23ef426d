#include "present/tonemap.h"

namespace pocketray {
namespace {

// c^(1/2.4) = (c^(1/12))^5, the twelfth root by Newton's method, using only +, ×, ÷.
constexpr double twelfth_root(double c) {
  double y = 1;
  for (int i = 0; i < 40; ++i) {
    double y2 = y * y, y4 = y2 * y2, y11 = y4 * y4 * y2 * y;
    y = (11 * y + c / y11) / 12;
  }
  return y;
}
constexpr double srgb_encode(double linear) {
  if (linear <= 0.0031308) return 12.92 * linear;
  double root = twelfth_root(linear), root2 = root * root;
  return 1.055 * root2 * root2 * root - 0.055;
}

// The bits of a non-negative float below 2, using only +, ×, ÷: memcpy is not constexpr.
constexpr std::uint32_t bits_of(float value) {
  if (value == 0) return 0;
  std::uint32_t exponent = 127;
  double mantissa = value;
  while (mantissa < 1) mantissa *= 2, --exponent;
  return (exponent << 23) | static_cast<std::uint32_t>((mantissa - 1) * (1 << 23));
}
constexpr double bucket_edge(std::uint32_t bucket) {
  double edge = 1 + (bucket % 128) / 128.0;
  for (std::uint32_t octave = bucket / 128; octave < kToneOctaves; ++octave) edge /= 2;
  return edge;
}

constexpr ToneTables make_tone_tables() {
  ToneTables t = {};
  for (int level = 0; level < 256; ++level) t.threshold[level] = bits_of(kSrgb.threshold[level]);
  t.threshold[256] = 0xffffffff;
  std::uint32_t level = 0;
  for (std::uint32_t bucket = 0; bucket < kToneBucketCount; ++bucket) {
    while (t.threshold[level + 1] <= kToneBitsMin + (bucket << 16)) ++level;
    t.level[bucket] = static_cast<std::uint8_t>(level);
  }
  for (std::uint32_t bucket = 0; bucket <= kToneBucketCount; ++bucket)
    t.fine[bucket] = static_cast<std::uint16_t>(srgb_encode(bucket_edge(bucket)) * 65535 + 0.5);
  return t;
}

}  // namespace

constexpr ToneTables kToneTables = make_tone_tables();

bool tone_saturates(std::uint32_t bits, ToneCounts* counts) {
  constexpr std::uint32_t kSign = 1u << 31, kInfinity = 255u << 23;
  if ((bits & ~kSign) > kInfinity) {
    ++counts->nan;
    return false;
  }
  if (bits & kSign) {
    counts->negative += bits != kSign;
    return false;
  }
  counts->infinite += bits == kInfinity;
  return true;
}

}  // namespace pocketray
