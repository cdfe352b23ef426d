// How a display shows light that is brighter than it can show.
#pragma once
#include <cstdint>
#include <cstring>

#include "base/limits.h"
#include "base/vec3.h"

namespace pocketray {

// clip: each channel ends at 1. film: a shoulder, see with_shoulder().
enum class Tone : std::uint8_t { clip, film };
constexpr int kToneCount = 2;
constexpr const char* kToneNames[kToneCount] = {"clip", "film"};
// By a name of kToneNames.
inline Tone tone_named(const char* name) { return std::strcmp(name, kToneNames[0]) == 0 ? Tone::clip : Tone::film; }

// A display shows exposure × radiance, by the tone's curve.
struct Display {
  float exposure;
  Tone tone = Tone::clip;
  Display(float exposure_, Tone tone_ = Tone::clip) : exposure(exposure_), tone(tone_) {}
};

// Khronos PBR Neutral Tone Mapper, "Specification", without its subtraction of Fresnel's reflection: where the shoulder
// begins, and how soon colours above it fade to white.
constexpr float kShoulder = 0.8f, kFading = 0.15f;

// Lowers the largest channel m, if it is above kShoulder, along a curve that continues the straight line without a bend
// and approaches 1, the others in proportion, and fades the colour to white as m grows. Channels below 0, infinite ones
// and NaN stay.
inline Vec3 with_shoulder(const Vec3& c) {
  const float most = max_component(c);
  if (!(most > kShoulder && most <= kRadianceMax)) return c;
  constexpr float kRoom = 1 - kShoulder;
  const float shown = 1 - kRoom * kRoom / (most + (kRoom - kShoulder));
  const float color = 1 / (kFading * (most - shown) + 1);  // the rest is white
  const float scale = color * (shown / most), white = shown - shown * color;
  Vec3 faded = c;
  for (int i = 0; i < 3; ++i)
    if (c[i] >= 0) faded[i] = c[i] * scale + white;
  return faded;
}
inline Vec3 toned(const Vec3& exposed, Tone tone) { return tone == Tone::film ? with_shoulder(exposed) : exposed; }

}  // namespace pocketray
