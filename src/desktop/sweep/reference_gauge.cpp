#include "desktop/sweep/reference_gauge.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "desktop/sweep/reference_share.h"

namespace pocketray {
namespace {

// ꟻLIP falls as the number of samples to this power: its exponent for colours [Andersson20, sec. 4.1, q_c] times that
// of the standard error.
constexpr double kFlipFall = 0.35;

double own_flip(const ReferenceGauge& gauge) {
  ReferencePictures pictures;
  develop(*gauge.accumulation, display_of(gauge.rig->opened.renderer), gauge.goal.pixels_per_degree, &pictures);
  return pictures.flip;
}

}  // namespace

ReferenceGauge::ReferenceGauge(const ReferenceGoal& g, const Rig* r, const Accumulation* a)
    : goal(g), rig(r), accumulation(a), saved_ns(clock_ns()) {
  CHECK(rig != nullptr && accumulation != nullptr);
  const std::uint32_t batch_count = (half_samples(goal) + kReferenceBatch - 1) / kReferenceBatch;
  text = std::string(name_of(goal.transport)) + " reference";
  most = goal.samples ? std::uint64_t(batch_count / goal.part_count + 1) * accumulation->height : 0;
  progress = start_progress(text.c_str(), most);
  progress.later = goal.later;
}

std::uint32_t half_samples(const ReferenceGoal& goal) {
  return goal.samples ? (goal.samples + 1) / kReferenceHalfCount : kReferenceSampleMax;
}

bool is_good_enough(std::uint32_t batches, ReferenceGauge* gauge) {
  CHECK(gauge != nullptr);
  double flip = own_flip(*gauge), until = gauge->goal.until;
  char said[96];
  std::snprintf(said, sizeof said, "%s reference, its error ꟻLIP %.4f so far", name_of(gauge->goal.transport), flip);
  gauge->text = said;
  gauge->progress.what = gauge->text.c_str();
  if (until == 0) return false;
  double more = static_cast<double>(batches) * (std::pow(flip / until, 1 / kFlipFall) - 1) / gauge->goal.part_count;
  double total = static_cast<double>(gauge->done) + std::fmin(0x1p60, std::fmax(0, more) * gauge->accumulation->height);
  gauge->progress.total = static_cast<std::uint64_t>(total);
  if (gauge->most > 0) gauge->progress.total = std::min(gauge->progress.total, gauge->most);
  return flip <= until;
}

bool is_good_enough_already(ReferenceGauge* gauge) {
  auto there = static_cast<std::uint32_t>(samples_of(*gauge->accumulation) / kReferenceHalfCount / kReferenceBatch);
  return gauge->goal.until > 0 && there > 0 && is_good_enough(there, gauge);
}

bool must_save(const ReferenceGauge& gauge) {
  return static_cast<double>(clock_ns() - gauge.saved_ns) >= gauge.goal.save_seconds * 1e9;
}

void save_meanwhile(ReferenceGauge* gauge) {
  CHECK(gauge != nullptr);
  (void)save_accumulation(gauge->goal.path, *gauge->accumulation);
  gauge->saved_ns = clock_ns();
}

}  // namespace pocketray
