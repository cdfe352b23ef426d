// Linear light ↔ sRGB display levels (IEC 61966-2-1). The compiler makes the tables with +, ×, ÷ alone, without libm,
// so they are the same everywhere. sRGB 0.5 → 188, 0.18 → 118 (HARDCASES row 64).
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

// Half the width of the narrowest display level: a smaller change moves a pixel by at most one level.
constexpr float kHalfLevel = 0.5f / (255.0f * 12.92f);

struct SrgbTables {
  float linear[256] = {};     // level → linear light
  float threshold[256] = {};  // least linear light displayed as this level
};

constexpr double fifth_root(double x) {
  double y = 1;
  for (int i = 0; i < 60; ++i) y = (4 * y + x / (y * y * y * y)) / 5;
  return y;
}
constexpr double srgb_decode(double c) {
  if (c <= 0.04045) return c / 12.92;
  double y = (c + 0.055) / 1.055;
  return y * y * fifth_root(y * y);  // y^2.4
}
constexpr SrgbTables make_srgb_tables() {
  SrgbTables t;
  for (int level = 0; level < 256; ++level) {
    t.linear[level] = static_cast<float>(srgb_decode(level / 255.0));
    t.threshold[level] = level ? static_cast<float>(srgb_decode((level - 0.5) / 255.0)) : 0.0f;
  }
  return t;
}
inline constexpr SrgbTables kSrgb = make_srgb_tables();

// Level 0–255 of linear light. NaN and values below zero give 0, values above one give 255.
inline std::uint8_t srgb_level(float linear) {
  int level = 0;
  for (int step = 128; step; step >>= 1)
    if (linear >= kSrgb.threshold[level + step]) level += step;
  return static_cast<std::uint8_t>(level);
}
inline float srgb_to_linear(std::uint8_t level) { return kSrgb.linear[level]; }

// Luminance of linear sRGB primaries (Rec. 709).
inline float luminance(const Vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace pocketray
