// Progress of a running reference: its error, how much is left, and saves.
#pragma once
#include "desktop/sweep/reference_run.h"

namespace pocketray {

struct ReferenceGauge {
  const ReferenceGoal& goal;
  const Rig* rig;
  const Accumulation* accumulation;
  std::uint64_t saved_ns, done = 0, most = 0;  // row batches done or already present; maximum; 0: unknown
  Progress progress = {};
  std::string text = {};  // text of the progress

  // Starts the progress; all arguments must outlive the gauge.
  ReferenceGauge(const ReferenceGoal& goal, const Rig* rig, const Accumulation* accumulation);
  ReferenceGauge(const ReferenceGauge&) = delete;
  ReferenceGauge& operator=(const ReferenceGauge&) = delete;
};

// Maximum number of samples of each half.
std::uint32_t half_samples(const ReferenceGoal& goal);
// Measures and reports the error, and estimates how much is left. Returns true if it is small enough.
bool is_good_enough(std::uint32_t batches, ReferenceGauge* gauge);
// Likewise for samples that exist before the first is taken.
bool is_good_enough_already(ReferenceGauge* gauge);
bool must_save(const ReferenceGauge& gauge);
// If saving fails, the next save tries again, at the latest the final one.
void save_meanwhile(ReferenceGauge* gauge);

}  // namespace pocketray
