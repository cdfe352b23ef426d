#include "desktop/sweep/reference_run.h"

#include <algorithm>
#include <mutex>

#include "base/check.h"
#include "desktop/sweep/reference_gauge.h"
#include "desktop/sweep/reference_share.h"
#include "desktop/sweep/reference_team.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

struct Run {
  const ReferenceGoal& goal;
  Rig* rig;
  Accumulation* accumulation;
  ReferenceGauge gauge;
  std::mutex mutex = {};
  std::vector<ReferencePiece> work = {};

  Run(const ReferenceGoal& g, Rig* r, Accumulation* a) : goal(g), rig(r), accumulation(a), gauge(g, r, a) {}
};

bool take_work(void* context, std::uint32_t, std::uint32_t i) {
  Run* run = static_cast<Run*>(context);
  const ReferencePiece& work = run->work[i];
  accumulate(run->rig->reference, run->goal.transport, work.row, work.samples, run->accumulation);
  std::lock_guard<std::mutex> lock(run->mutex);
  show_progress(&run->gauge.progress, ++run->gauge.done);
  if (run->goal.row_done) run->goal.row_done(work.row);
  return !interrupted && !must_save(run->gauge);
}

std::vector<ReferencePiece> missing_work(const Accumulation& accumulation, const SampleRange& samples) {
  std::vector<ReferencePiece> work;
  for (std::uint32_t row = 0; row < accumulation.height; ++row)
    for (const SampleRange& missing : missing_samples(accumulation.rows[row], samples)) work.push_back({row, missing});
  return work;
}

// Adds a batch to all rows that lack it, saving in between.
Status take_batch(const SampleRange& samples, Run* run) {
  for (;;) {
    run->work = missing_work(*run->accumulation, samples);
    if (run->work.empty() || interrupted) return success();
    share_items(run->rig->opened.renderer.workers, 0, static_cast<std::uint32_t>(run->work.size()), take_work, run);
    if (must_save(run->gauge)) save_meanwhile(&run->gauge);
  }
}

// Takes the samples that the goal lacks with this process alone.
Status take_alone(Run* run) {
  const ReferenceGoal& goal = run->goal;
  const std::uint32_t end = half_samples(goal), batch_count = (end + kReferenceBatch - 1) / kReferenceBatch;
  MeasureSchedule schedule;
  bool enough = is_good_enough_already(&run->gauge);
  for (std::uint32_t batch = goal.part - 1; batch < batch_count && !enough && !interrupted; batch += goal.part_count) {
    SampleRange samples = {batch * kReferenceBatch, std::min(end, (batch + 1) * kReferenceBatch)};
    bool was_there = missing_work(*run->accumulation, samples).empty();
    if (was_there) run->gauge.done += run->accumulation->height;
    RETURN_IF_ERROR(take_batch(samples, run));
    if (!schedule.is_due_after(batch)) continue;
    if (!was_there && !interrupted) enough = is_good_enough(batch + 1, &run->gauge);
  }
  return success();
}

}  // namespace

Status run_reference(const ReferenceGoal& goal, Rig* rig, Accumulation* accumulation, bool* whole) {
  CHECK(rig != nullptr && accumulation != nullptr && whole != nullptr);
  CHECK(goal.samples > 0 || goal.until > 0);
  CHECK(goal.part >= 1 && goal.part <= goal.part_count);
  make_rig_reference(rig);
  Run run(goal, rig, accumulation);
  Status status = goal.team.size > 1 ? take_with_team(goal, rig, accumulation, &run.gauge) : take_alone(&run);
  end_progress(&run.gauge.progress);
  *whole = !interrupted;
  RETURN_IF_ERROR(status);
  return save_accumulation(goal.path, *accumulation);
}

}  // namespace pocketray
