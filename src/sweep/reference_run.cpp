#include "sweep/reference_run.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/check.h"
#include "session/interrupt.h"
#include "session/progress.h"

namespace pocketray {
namespace {

// Samples of each half between which a row's may be saved; small, since an interrupt waits for them.
constexpr std::uint32_t kBatch = 4;
// The error is measured whenever the number of batches has grown by this factor.
constexpr double kMeasureGrowth = 1.1;
// ꟻLIP falls as the number of samples to this power: its exponent for colours [Andersson20, sec. 4.1, q_c] times that
// of the standard error.
constexpr double kFlipFall = 0.35;

struct Work {
  std::uint32_t row;
  SampleRange samples;
};

struct Run {
  const ReferenceGoal& goal;
  Rig* rig;
  Accumulation* accumulation;
  std::uint64_t saved_ns, done = 0, most = 0;  // rows' batches done, or there already; at most; 0: unknown
  std::mutex mutex = {};
  Progress progress = {};
  std::string text = {};  // what the progress says
  std::vector<Work> work = {};

  Run(const ReferenceGoal& g, Rig* r, Accumulation* a) : goal(g), rig(r), accumulation(a), saved_ns(clock_ns()) {}
};

bool must_save(const Run& run) { return static_cast<double>(clock_ns() - run.saved_ns) >= run.goal.save_seconds * 1e9; }

bool take_work(void* context, std::uint32_t, std::uint32_t i) {
  Run* run = static_cast<Run*>(context);
  const Work& work = run->work[i];
  accumulate(run->rig->reference, run->goal.transport, work.row, work.samples, run->accumulation);
  std::lock_guard<std::mutex> lock(run->mutex);
  show_progress(&run->progress, ++run->done);
  if (run->goal.row_done) run->goal.row_done(work.row);
  return !interrupted && !must_save(*run);
}

std::vector<Work> missing_work(const Accumulation& accumulation, const SampleRange& samples) {
  std::vector<Work> work;
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
    if (!must_save(*run)) continue;
    // If saving fails, the next save tries again, at the latest the final one.
    (void)save_accumulation(run->goal.path, *run->accumulation);
    run->saved_ns = clock_ns();
  }
}

double own_flip(const Run& run) {
  ReferencePictures pictures;
  develop(*run.accumulation, static_cast<double>(run.rig->opened.renderer.exposure), run.goal.pixels_per_degree,
          &pictures);
  return pictures.flip;
}

// Measures the error, tells it, and estimates how much is left. True if it is small enough.
bool is_good_enough(std::uint32_t batches, Run* run) {
  double flip = own_flip(*run), until = run->goal.until;
  char text[96];
  std::snprintf(text, sizeof text, "%s reference, its error ꟻLIP %.4f so far", name_of(run->goal.transport), flip);
  run->text = text;
  run->progress.what = run->text.c_str();
  if (until == 0) return false;
  double more = static_cast<double>(batches) * (std::pow(flip / until, 1 / kFlipFall) - 1) / run->goal.part_count;
  double total = static_cast<double>(run->done) + std::fmin(0x1p60, std::fmax(0, more) * run->accumulation->height);
  run->progress.total = static_cast<std::uint64_t>(total);
  if (run->most > 0) run->progress.total = std::min(run->progress.total, run->most);
  return flip <= until;
}

}  // namespace

Status run_reference(const ReferenceGoal& goal, Rig* rig, Accumulation* accumulation, bool* whole) {
  CHECK(rig != nullptr && accumulation != nullptr && whole != nullptr);
  CHECK(goal.samples > 0 || goal.until > 0);
  CHECK(goal.part >= 1 && goal.part <= goal.part_count);
  make_rig_reference(rig);
  Run run(goal, rig, accumulation);
  std::uint32_t end = goal.samples ? (goal.samples + 1) / kReferenceHalfCount : kReferenceSampleMax;
  std::uint32_t batch_count = (end + kBatch - 1) / kBatch;
  run.text = std::string(name_of(goal.transport)) + " reference";
  run.most = goal.samples ? std::uint64_t(batch_count / goal.part_count + 1) * accumulation->height : 0;
  run.progress = start_progress(run.text.c_str(), run.most);
  Status status;
  auto there = static_cast<std::uint32_t>(samples_of(*accumulation) / kReferenceHalfCount / kBatch);
  bool enough = goal.until > 0 && there > 0 && is_good_enough(there, &run);
  std::uint32_t measure_at = 2;
  for (std::uint32_t batch = goal.part - 1; batch < batch_count && !enough && !interrupted && status.ok;
       batch += goal.part_count) {
    SampleRange samples = {batch * kBatch, std::min(end, (batch + 1) * kBatch)};
    bool was_there = missing_work(*accumulation, samples).empty();
    if (was_there) run.done += accumulation->height;
    status = take_batch(samples, &run);
    if (batch + 1 < measure_at) continue;
    measure_at = std::max(batch + 2, static_cast<std::uint32_t>(kMeasureGrowth * (batch + 1)));
    if (!was_there && !interrupted) enough = is_good_enough(batch + 1, &run);
  }
  end_progress(&run.progress);
  *whole = !interrupted;
  RETURN_IF_ERROR(status);
  return save_accumulation(goal.path, *accumulation);
}

}  // namespace pocketray
