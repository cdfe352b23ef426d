// Two ways to share a frame: by rows, or by effect, where the device traces all rows with what indirect light it has
// itself, and a server renders the indirect light at fewer pixels (light_map). Which of them is faster is measured:
// both are tried, and each again now and then. Pure: the caller measures.
#pragma once
#include <cstdint>

#include "split/smooth.h"

namespace pocketray {

enum class SplitKind : std::uint8_t { rows, effect, automatic };

// What a frame by effect took, in nanoseconds. The server's work and the transfer overlap with the device's tracing.
struct EffectTimes {
  double prepare_ns = 0;   // of the device, before its first pixel
  double device_ns = 0;    // its tracing of all rows
  double server_ns = 0;    // work on the light, at its price; 0: none was needed
  double transfer_ns = 0;  // from the request to the light's arrival, without that work
  double add_ns = 0;       // to add the light
};

struct EffectChoice {
  Smoothed rows_ns;  // of whole frames by rows
  Smoothed prepare_ns, device_ns, server_ns, transfer_ns, add_ns;
  std::uint32_t rows_count = 0, effect_count = 0;  // frames since the choice last changed, or since the other was tried
  bool by_effect = false;                          // the last choice
};

// Chosen: frames until a way is known well enough to compare, frames between two trials of the slower one, each of
// which costs at most what that one takes longer for a frame, and how much faster a way must be for a change.
constexpr std::uint32_t kTrialFrames = 3, kRetryFrames = 128;
constexpr double kFasterPart = 0.95;

// How long the next frame by effect will take; 0: unknown.
double predict_effect_ns(const EffectChoice& choice);

// Records a frame that was shared by rows, or by effect.
void observe_rows_frame(EffectChoice* choice, double ns);
void observe_effect_frame(EffectChoice* choice, const EffectTimes& times);

// Whether to share the next frame by effect. Frames begin by rows.
bool choose_by_effect(EffectChoice* choice);

}  // namespace pocketray
