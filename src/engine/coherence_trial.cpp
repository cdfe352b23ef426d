#include "engine/coherence_trial.h"

#include <algorithm>
#include <cmath>

namespace pocketray {
namespace {

// Derived: a frame that saves less than a thirtieth does not pay, and a failed try must cost less than it delays the
// frames traced whole after it. Rests double, so scenes in which everything moves recover the cost of the first tries.
// Savings act as credit, up to one frame's time, so that an interruption of the program causes no rest. After 31
// frames, a try that cost most of a frame is within kMostLoss; after 255, one that cost seven. Longer rests, chosen,
// would take seconds to notice that a scene has calmed down.
constexpr double kLeastGain = 0.97;
constexpr double kMostLoss = 0.03;
constexpr std::uint32_t kRestMax = 31, kLongRestMax = 255;
// Measured, `bench --coherence`: recording multiplies a frame's time by up to 1.3. Used until a plain frame is timed.
constexpr double kPlainShare = 0.75;

void rest_for(CoherenceTrial* trial, std::uint32_t frames) {
  if (frames > 0) trial->credit_ns = 0;
  trial->rest = frames;
  trial->rest_next = std::min(2 * frames + 1, kRestMax);
}

}  // namespace

void rest_after(CoherenceTrial* trial, bool did_pay) { rest_for(trial, did_pay ? 0 : trial->rest_next); }

bool rests(CoherenceTrial* trial) {
  trial->is_warming = trial->is_cold;
  trial->is_cold = false;
  if (trial->is_warming) return true;
  trial->tries_again = trial->rest == 0 && trial->was_resting;
  trial->was_resting = trial->rest > 0;
  trial->rest -= trial->was_resting;
  return trial->was_resting;
}

void weigh_frame(CoherenceTrial* trial, FrameKind kind, double ns) {
  if (trial->is_warming) return;
  const bool in_vain = kind == FrameKind::recorded && trial->was_recorded;
  trial->was_recorded = kind == FrameKind::recorded;
  if (kind == FrameKind::plain) trial->plain_ns = ns;
  if (kind == FrameKind::recorded) trial->recorded_ns = ns;
  if (kind != FrameKind::coherent && !in_vain) return;
  const double plain = trial->plain_ns > 0 ? trial->plain_ns : kPlainShare * trial->recorded_ns;
  if (kind == FrameKind::coherent) trial->credit_ns = std::min(trial->credit_ns + kLeastGain * plain - ns, plain);
  const bool did_pay = kind == FrameKind::coherent && trial->credit_ns > 0;
  double loss = trial->recorded_ns - plain;
  if (kind == FrameKind::coherent) loss += ns - plain;
  rest_after(trial, did_pay);
  if (did_pay || trial->plain_ns <= 0) return;
  const double least = std::min<double>(std::ceil(loss / (kMostLoss * plain)), kLongRestMax);
  if (least > trial->rest) rest_for(trial, static_cast<std::uint32_t>(least));
}

}  // namespace pocketray
