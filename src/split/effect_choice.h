// Two ways to share a frame: by rows, or by effect, where the device traces its rows with what indirect light it has
// itself, and a server renders the indirect light at fewer pixels (light_map). The cost model prices both; how far its
// times are off for either is measured: both are tried, and each again now and then. Pure: the caller measures.
#pragma once
#include <cstdint>

#include "split/smooth.h"

namespace pocketray {

enum class SplitKind : std::uint8_t { rows, effect, automatic };

// What a frame by effect took, in nanoseconds. The server's work and the transfer overlap with the device's tracing.
struct EffectTimes {
  double prepare_ns = 0;   // of the device, before its first pixel
  double device_ns = 0;    // its tracing
  double server_ns = 0;    // work on the light, at its price; 0: none was needed
  double transfer_ns = 0;  // from the request to the light's arrival, without that work
  double add_ns = 0;       // to add the light
};

// Their means, of frames of which the device traces all rows.
struct EffectModel {
  Smoothed prepare_ns, device_ns, server_ns, transfer_ns, add_ns;
};
void observe_effect_times(EffectModel* model, const EffectTimes& times);
// How long the next such frame will take; 0: unknown.
double predict_effect_ns(const EffectModel& model);

// Chosen: frames until a way is known well enough to compare; frames between two trials of the slower one, at first and
// after many in vain, each of which costs at most what that one takes longer for a frame; and how much less time frames
// by effect must take, as those by rows have the better picture.
constexpr std::uint32_t kTrialFrames = 3, kRetryFramesMin = 8, kRetryFrames = 128;
constexpr double kFasterPart = 0.95;

struct EffectChoice {
  Smoothed rows_error, effect_error;         // time over the predicted one
  std::uint32_t count = 0;                   // frames since the way last changed,
  bool by_effect = false, on_trial = false;  // which is this one, perhaps for a trial
  std::uint32_t retry = kRetryFramesMin;     // frames until the next trial of the other
};

// Records a frame that was shared in that way. predicted_ns 0: unknown.
void observe_choice(EffectChoice* choice, bool by_effect, double predicted_ns, double ns);

// Whether to share the next frame by effect, if it is expected to take so long in either way, by the cost model's times
// and their errors; 0: unknown. Frames begin by rows.
bool choose_by_effect(EffectChoice* choice, double rows_ns, double effect_ns);

}  // namespace pocketray
