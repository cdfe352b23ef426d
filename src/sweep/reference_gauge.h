// How far a running reference is: its error, progress and saves.
#pragma once
#include "sweep/reference_run.h"

namespace pocketray {

struct ReferenceGauge {
  const ReferenceGoal& goal;
  const Rig* rig;
  const Accumulation* accumulation;
  std::uint64_t saved_ns, done = 0, most = 0;  // rows' batches done, or there already; at most; 0: unknown
  Progress progress = {};
  std::string text = {};  // what the progress says

  // Starts the progress; all must outlive the gauge.
  ReferenceGauge(const ReferenceGoal& goal, const Rig* rig, const Accumulation* accumulation);
  ReferenceGauge(const ReferenceGauge&) = delete;
  ReferenceGauge& operator=(const ReferenceGauge&) = delete;
};

// Samples of each half to take at most.
std::uint32_t half_samples(const ReferenceGoal& goal);
// Measures the error, tells it, and estimates how much is left. True if it is small enough.
bool is_good_enough(std::uint32_t batches, ReferenceGauge* gauge);
// The same for samples that are there before the first is taken.
bool is_good_enough_already(ReferenceGauge* gauge);
bool must_save(const ReferenceGauge& gauge);
// If saving fails, the next save tries again, at the latest the final one.
void save_meanwhile(ReferenceGauge* gauge);

}  // namespace pocketray
