// How a display shows light that is brighter than it can show.
#pragma once
#include <cstdint>

#include "base/limits.h"
#include "base/vec3.h"

namespace pocketray {

// clip: each channel ends at 1. film: a shoulder above half of white, see with_shoulder().
enum class Tone : std::uint8_t { clip, film };
constexpr int kToneCount = 2;
constexpr const char* kToneNames[kToneCount] = {"clip", "film"};

// A display shows exposure × radiance, by the tone's curve.
struct Display {
  float exposure;
  Tone tone = Tone::clip;
  Display(float exposure_, Tone tone_ = Tone::clip) : exposure(exposure_), tone(tone_) {}
};

// Where the shoulder begins.
constexpr float kShoulder = 0.5f;

// Scales a colour so that its largest channel m becomes 1 − 1 / 4m, if it is above kShoulder: the curve continues the
// straight line without a bend and approaches 1. The ratios of the channels, and so the hue, stay. Infinite channels
// and NaN stay, too.
inline Vec3 with_shoulder(const Vec3& c) {
  const float most = max_component(c);
  if (!(most > kShoulder && most <= kRadianceMax)) return c;
  const float inverse = 1 / most;
  return c * (inverse - inverse * inverse * (kShoulder * kShoulder));
}
inline Vec3 toned(const Vec3& exposed, Tone tone) { return tone == Tone::film ? with_shoulder(exposed) : exposed; }

}  // namespace pocketray
