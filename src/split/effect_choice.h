// Two ways to share a frame: by rows, or by effect, where the device traces its rows with its own indirect light, if
// any, and a server renders the indirect light at fewer pixels (light_map). The cost model prices both ways; its error
// for each is measured: both are tried, and retried now and then. Pure: the caller measures.
#pragma once
#include <cstdint>

#include "split/smooth.h"

namespace pocketray {

enum class SplitKind : std::uint8_t { rows, effect, automatic };

// Times of a frame by effect, in nanoseconds. The server's work and the transfer overlap with the device's tracing.
struct EffectTimes {
  double prepare_ns = 0;   // device time before its first pixel
  double device_ns = 0;    // device time for tracing
  double server_ns = 0;    // work on the light, at the server's price; 0: none was needed
  double transfer_ns = 0;  // from the request to the light's arrival, excluding that work
  double add_ns = 0;       // device time to add the light
};

// Means over frames in which the device traces all rows.
struct EffectModel {
  Smoothed prepare_ns, device_ns, server_ns, transfer_ns, add_ns;
};
void observe_effect_times(EffectModel* model, const EffectTimes& times);
// Predicted time of the next such frame; 0: unknown.
double predict_effect_ns(const EffectModel& model);

// Chosen: frames until a way is known well enough to compare; frames between two trials of the slower way, initially
// and after many failures, each of which costs at most that way's extra time for a frame; and the time fraction that by
// effect must stay below, since by rows has the better picture.
constexpr std::uint32_t kTrialFrames = 3, kRetryFramesMin = 8, kRetryFrames = 128;
constexpr double kFasterPart = 0.95;

struct EffectChoice {
  Smoothed rows_error, effect_error;         // measured over predicted time
  std::uint32_t count = 0;                   // frames since the last change of the way,
  bool by_effect = false, on_trial = false;  // the current way, perhaps for a trial
  std::uint32_t retry = kRetryFramesMin;     // frames until the next trial of the other way
};

// Records a frame shared in that way. predicted_ns 0: unknown.
void observe_choice(EffectChoice* choice, bool by_effect, double predicted_ns, double ns);

// Returns whether to share the next frame by effect, given the cost model's predicted time for each way, corrected by
// their measured errors; 0: unknown. Starts by rows.
bool choose_by_effect(EffectChoice* choice, double rows_ns, double effect_ns);

}  // namespace pocketray
