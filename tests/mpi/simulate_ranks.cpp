// simulate_ranks [SCENE [SAMPLES]] : how much sooner 2 … 64 ranks have a reference, and 351 frames, than one program.
// Measures on this machine what a sample of each row costs, and what the leader does besides: adding rows of helpers,
// measuring the error, saving. Then plays the leader and its helpers on a virtual clock; pieces are given out by the
// code that gives them out in earnest. Each rank has one thread; rank 0 is reached by 1 Gbit/s Ethernet, on which rows
// queue up.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <queue>

#include "base/check.h"
#include "desktop/sweep/reference_gauge.h"
#include "desktop/sweep/reference_share.h"
#include "desktop/sweep/rigs.h"
#include "session/report.h"
#include "simulate_frames.h"

using namespace pocketray;

namespace {

constexpr double kBytesPerSecond = 125e6, kLatencySeconds = 100e-6;
constexpr std::uint32_t kPortionsAhead = 2;  // as reference_team.cpp has it
constexpr double kSaveSeconds = 60, kTellSeconds = 10, kWaitSeconds = 0.05;

// Seconds, but for the bytes.
struct Costs {
  std::vector<double> sample;  // of a row, both halves
  double add = 0, measure = 0, save = 0, open = 0;
  double row_bytes = 0;
};

// Of this program's CPU time, which other work on the machine changes little.
double now_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Status measure_costs(const std::string& scene, const std::string& file, Costs* costs, ReferenceGoal* goal) {
  AccuracyOptions options;
  options.common.scene = scene, options.common.threads = 1;
  std::unique_ptr<Rig> rig;
  double start = now_seconds();
  RETURN_IF_ERROR(open_rig(options, scene == "cornell" ? kReferenceColumns : kCornellSphereColumns, &rig));
  RETURN_IF_ERROR(prepare_for_reference(0, rig.get()));
  make_rig_reference(rig.get());
  costs->open = (now_seconds() - start);
  const Settings& settings = rig->opened.renderer.settings;
  Accumulation sum = empty_accumulation(reference_key(*rig, options, goal->transport), settings.width, settings.height);
  std::vector<RowSamples> rows;
  for (std::uint32_t row = 0; row < settings.height; ++row) {
    start = now_seconds();
    rows.push_back(take_row(rig->reference, goal->transport, row, {0, kReferenceBatch}));
    costs->sample.push_back((now_seconds() - start) / kReferenceBatch);
  }
  costs->row_bytes = static_cast<double>(rows[0].sums.size() * sizeof rows[0].sums[0]);
  start = now_seconds();
  for (const RowSamples& row : rows) {
    RowSamples received = row;  // as from a message
    RETURN_IF_ERROR(merge(received, &sum));
  }
  costs->add = (now_seconds() - start) / settings.height;
  goal->path = file;
  ReferenceGauge gauge(*goal, rig.get(), &sum);
  start = now_seconds();
  (void)is_good_enough(1, &gauge);
  costs->measure = (now_seconds() - start);
  start = now_seconds();
  Status status = save_accumulation(file, sum);
  costs->save = (now_seconds() - start);
  std::remove(file.c_str());
  return status;
}

// A row from nowhere.
RowSamples row_of(const ReferencePiece& piece) {
  return {piece.row, piece.samples, std::vector<ExactSum>(kReferenceHalfCount * 3)};
}

// One program: every batch, and the error at every measurement.
double seconds_alone(const Costs& costs, std::uint32_t samples) {
  double seconds = costs.open, rows = 0;
  for (double sample : costs.sample) rows += sample;
  MeasureSchedule schedule;
  for (std::uint32_t batch = 0; batch * kReferenceBatch < samples; ++batch) {
    seconds += rows * std::min(kReferenceBatch, samples - batch * kReferenceBatch);
    if (schedule.is_due_after(batch)) seconds += costs.measure;
  }
  return seconds * (1 + costs.save / kSaveSeconds) + costs.save;
}

struct Arrival {
  double seconds;
  std::uint32_t rank;
  std::vector<ReferencePiece> pieces;
  bool operator<(const Arrival& other) const { return seconds > other.seconds; }
};

class Simulation {
 public:
  Simulation(const Costs& costs, std::uint32_t ranks, std::uint32_t samples, std::uint32_t until_batches)
      : costs_(costs),
        until_batches_(until_batches),
        sum_(empty_accumulation("", 1, static_cast<std::uint32_t>(costs.sample.size()))),
        share_(samples, 1, 1, until_batches > 0, &sum_),
        helpers_(ranks),
        now_(costs.open),
        link_free_(now_),
        saved_(now_),
        told_(now_) {
    for (Helper& helper : helpers_) helper.free = costs.open;
  }

  double run() {
    for (bool enough = false; !enough && !share_.is_done();) {
      serve();
      give();
      enough = end_rounds();
      if (enough || share_.is_done()) break;
      give();
      const std::vector<ReferencePiece> own = share_.take(1);
      for (const ReferencePiece& piece : own) now_ += work(piece) + costs_.add, add(piece);
      if (own.empty()) now_ = std::max(now_, std::min(next_arrival(), now_ + kWaitSeconds));
      if (now_ - saved_ > kSaveSeconds) now_ += costs_.save, saved_ = now_;
    }
    while (!arrivals_.empty()) now_ = std::max(now_, arrivals_.top().seconds), arrivals_.pop();
    return now_ + costs_.save;
  }

 private:
  struct Helper {
    double free = 0;
    std::uint32_t portions = 0;
  };

  double work(const ReferencePiece& piece) const {
    return costs_.sample[piece.row] * (piece.samples.end - piece.samples.begin);
  }
  double next_arrival() const { return arrivals_.empty() ? 1e30 : arrivals_.top().seconds; }
  void add(const ReferencePiece& piece) {
    Status status = share_.add(row_of(piece));
    CHECK(status.ok);
  }

  void serve() {
    while (next_arrival() <= now_) {
      for (const ReferencePiece& piece : arrivals_.top().pieces) add(piece), now_ += costs_.add;
      --helpers_[arrivals_.top().rank].portions;
      arrivals_.pop();
    }
  }

  // Every helper but rank 0, which is the leader. Rows that come back wait for each other on the way.
  void give() {
    for (std::uint32_t portions = 0; portions < kPortionsAhead; ++portions)
      for (std::uint32_t rank = 1; rank < helpers_.size(); ++rank) {
        Helper& helper = helpers_[rank];
        if (helper.portions != portions) continue;
        std::vector<ReferencePiece> pieces = share_.take_portion(1, static_cast<std::uint32_t>(helpers_.size()));
        if (pieces.empty()) return;
        helper.free = std::max(helper.free, now_ + kLatencySeconds);
        for (const ReferencePiece& piece : pieces) helper.free += work(piece);
        link_free_ =
            std::max(link_free_, helper.free) + costs_.row_bytes * static_cast<double>(pieces.size()) / kBytesPerSecond;
        arrivals_.push({link_free_ + kLatencySeconds, rank, pieces});
        ++helper.portions;
      }
  }

  bool end_rounds() {
    while (share_.is_first_round_done()) {
      const bool gated = until_batches_ > 0;
      if (share_.is_measured() && (gated || now_ - told_ > kTellSeconds)) now_ += costs_.measure, told_ = now_;
      if (gated && share_.batches() >= until_batches_) return true;
      Status status = share_.end_round();
      CHECK(status.ok);
    }
    return false;
  }

  const Costs& costs_;
  std::uint32_t until_batches_;
  Accumulation sum_;
  ReferenceShare share_;
  std::vector<Helper> helpers_;
  std::priority_queue<Arrival> arrivals_;
  double now_, link_free_, saved_, told_;
};

void print_speedups(const char* what, const Costs& costs, std::uint32_t samples, bool measured) {
  const std::uint32_t batches = (samples + kReferenceBatch - 1) / kReferenceBatch;
  const double alone = seconds_alone(costs, samples);
  std::printf("%s, %u samples per pixel: %.0f s alone\n ", what, kReferenceHalfCount * samples, alone);
  for (std::uint32_t ranks : {2u, 4u, 8u, 16u, 32u, 64u}) {
    Simulation simulation(costs, ranks, measured ? kReferenceSampleMax : samples, measured ? batches : 0);
    std::printf(" %u ranks %.1f×", ranks, alone / simulation.run());
  }
  std::printf("\n");
}

}  // namespace

int main(int argument_count, char** arguments) {
  ReferenceGoal goal;
  const std::string scene = argument_count > 1 ? arguments[1] : "cornell";
  const int samples = argument_count > 2 ? std::atoi(arguments[2]) : 1024;
  goal.samples = samples >= 8 ? static_cast<std::uint32_t>(samples) : 8;
  Costs costs;
  Status status = measure_costs(scene, "simulate_ranks.pfm", &costs, &goal);
  if (!status.ok) return report(status);
  std::vector<double> sorted = costs.sample;
  std::sort(sorted.begin(), sorted.end());
  std::printf(
      "%s: opening %.2f s, a sample of a row %.2f ms (%.2f … %.2f), adding a row of %.0f kB %.3f ms, measuring %.2f s, "
      "saving %.2f s\n",
      scene.c_str(), costs.open, 1e3 * sorted[sorted.size() / 2], 1e3 * sorted.front(), 1e3 * sorted.back(),
      1e-3 * costs.row_bytes, 1e3 * costs.add, costs.measure, costs.save);
  print_speedups("a number of samples", costs, goal.samples / kReferenceHalfCount, false);
  print_speedups("until an error", costs, goal.samples / kReferenceHalfCount, true);
  return report(simulate_frames("seesaw", 351, "simulate_ranks.png"));
}
