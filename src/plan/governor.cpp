#include "plan/governor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

// Natural logarithms. Chosen by tests/plan/governor_test.cpp to keep 95 % of
// the frames within 110 % of the budget.
constexpr double kLate = 0.0953;                           // 1.1
constexpr double kLimit = 0.077;                           // 1.08: leave a candidate expected to exceed it,
constexpr double kReturn = 0.03;                           // and return to one expected to stay below this
constexpr double kUnsettled = 0.1;                         // added to the load while few frames have been seen
constexpr double kDoubtGrowth = 0.001, kDoubtGrown = 0.2;  // per frame, for candidates that do not run; its limit
constexpr double kDoubtLeast = 0.02;                       // minimum doubt that makes a trial worthwhile
constexpr double kCorrectionMax = 3.5;                     // a factor of 33, far above the doubt of a guessed price
// Uses the maximum below kFewFrames loads; from kManyFrames on, of which two are 5 %, more may exceed the result.
constexpr std::uint32_t kFewFrames = 4, kManyFrames = 40;
// A surprise within kAttributedFrames after a switch is attributed to the candidate. Late frames are averaged over
// kLateFrames, enough to tell 3 % from 5.
constexpr std::uint32_t kAttributedFrames = 3, kLateFrames = 128;
// In frames. A candidate that never ran is tried every kTrialPause frames; those that ran and did not fit take up at
// most one frame in kAgainPauseMin, and ever fewer.
constexpr std::uint32_t kTrialPause = 8, kAgainPauseMin = 64, kAgainPauseMax = 1024;

double log_price(const Governor& g, std::uint32_t i) {
  return det_log(static_cast<double>(g.front.candidates[i].ns_per_pixel) * g.pixel_count) + g.corrections[i];
}

std::uint32_t load_count(const Governor& g) { return std::min(g.load_count, kLoadFrameCount); }
double last_load(const Governor& g) { return g.loads[(g.load_count - 1) % kLoadFrameCount]; }

// Median of the last few loads.
double middle_load(const Governor& g) {
  constexpr std::uint32_t kCount = 5;  // chosen: two outliers do not move it
  std::uint32_t count = std::min(g.load_count, kCount);
  if (count == 0) return 0;
  double values[kCount];
  for (std::uint32_t i = 0; i < count; ++i) values[i] = g.loads[(g.load_count - 1 - i) % kLoadFrameCount];
  std::sort(values, values + count);
  return count % 2 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

constexpr std::uint32_t kRankMax = 4;

// Returns the rank-th highest value, counted from 1.
double highest(const double* values, std::uint32_t count, std::uint32_t rank) {
  CHECK(rank >= 1 && rank <= kRankMax);
  CHECK_LE(count, kLoadFrameCount);
  double best[kRankMax] = {-1e300, -1e300, -1e300, -1e300};
  for (std::uint32_t i = 0; i < count; ++i) {
    double value = values[i];
    for (double& high : best)
      if (value > high) std::swap(value, high);
  }
  return best[rank - 1];
}

// A cautious prediction of the load.
double high_load(const Governor& g) {
  std::uint32_t count = load_count(g);
  if (count == 0) return kUnsettled;
  if (count < kFewFrames) return highest(g.loads, count, 1) + kUnsettled;
  // 3, 2 or 1 of 64 loads exceed it: 4.7, 3.1 or 1.6 %, fewer the more frames have been late.
  std::uint32_t rank = count < kManyFrames ? 2 : g.late_share < 0.02 ? 4 : g.late_share < 0.03 ? 3 : 2;
  double high = highest(g.loads, count, rank);
  if (count >= kManyFrames) high = std::min(high, middle_load(g) + highest(g.rises, count, rank));
  double before = g.loads[(g.load_count - 2) % kLoadFrameCount];
  return std::max(high, std::min(last_load(g), before));
}

// Returns whether a is more accurate than b.
bool is_better(const Governor& g, std::uint32_t a, std::uint32_t b) {
  float error_a = g.front.candidates[a].flip, error_b = g.front.candidates[b].flip;
  if (std::isnan(error_a) || std::isnan(error_b) || error_a == error_b) return a > b;
  return error_a < error_b;
}

std::uint32_t fastest(const Governor& g) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < g.front.count; ++i)
    if (log_price(g, i) < log_price(g, best)) best = i;
  return best;
}

// Returns the best candidate expected to stay within its limit, or the fastest if none is. The current candidate's
// limit is higher, so it is kept over a borderline alternative.
std::uint32_t choose(const Governor& g) {
  double load = high_load(g), budget = det_log(g.budget_ns);
  std::uint32_t best = g.front.count;
  for (std::uint32_t i = 0; i < g.front.count; ++i) {
    double over = log_price(g, i) + load - budget;
    if (over <= (i == g.home && g.load_count > 0 ? kLimit : kReturn) &&
        (best == g.front.count || is_better(g, i, best)))
      best = i;
  }
  return best < g.front.count ? best : fastest(g);
}

// Returns the cheapest of the better candidates that would fit if their price is overestimated; front.count: none.
std::uint32_t choose_trial(const Governor& g) {
  double load = high_load(g), budget = det_log(g.budget_ns);
  std::uint32_t best = g.front.count;
  for (std::uint32_t i = 0; i < g.front.count; ++i) {
    if (!is_better(g, i, g.home) || g.doubts[i] < kDoubtLeast) continue;
    if (log_price(g, i) + load - budget - g.doubts[i] > kReturn) continue;
    if (best == g.front.count || log_price(g, i) < log_price(g, best)) best = i;
  }
  return best;
}

// Tries new candidates soon, and retries those that did not fit after ever longer pauses.
std::uint32_t try_another(Governor* g) {
  std::uint32_t trial = choose_trial(*g);
  g->frames_to_trial = kTrialPause;
  if (trial == g->front.count) return g->home;
  if (g->ran[trial]) {
    g->frames_to_trial = g->trial_pause;
    g->trial_pause = std::min(2 * g->trial_pause, kAgainPauseMax);
  }
  g->on_trial = true;
  return trial;
}

// Corrections are relative: moves their mean into the loads.
void center_corrections(Governor* g) {
  double sum = 0;
  int count = 0;
  for (std::uint32_t i = 0; i < g->front.count; ++i)
    if (g->ran[i]) sum += g->corrections[i], ++count;
  CHECK_GT(count, 0);
  double mean = sum / count;
  for (std::uint32_t i = 0; i < g->front.count; ++i)
    if (g->ran[i]) g->corrections[i] -= mean;
  for (double& load : g->loads) load += mean;
  g->load_sum += mean * g->load_count;
  g->reference_low += mean;
  g->reference_high += mean;
}

// After a switch, attributes the load that earlier loads do not explain to the candidate.
void attribute(Governor* g, double load) {
  std::uint32_t i = g->current;
  double surprise = load - std::max(g->reference_low, std::min(g->reference_high, load));
  // A running mean at first, then a fifth of each: chosen, so that a price can still follow the scene.
  double share = std::max(0.2, 1.0 / (g->switches_to[i] + g->frames_at_current - 1));
  double moved =
      std::max(-kCorrectionMax, std::min(kCorrectionMax, g->corrections[i] + share * surprise)) - g->corrections[i];
  g->corrections[i] += moved;
  g->loads[(g->load_count - 1) % kLoadFrameCount] -= moved;
  g->rises[(g->load_count - 1) % kLoadFrameCount] -= moved;
  g->load_sum -= moved;
  center_corrections(g);
}

void switch_to(Governor* g, std::uint32_t candidate) {
  CHECK_LT(candidate, g->front.count);
  if (candidate == g->current) return;
  g->current = candidate;
  g->frames_at_current = 0;
  ++g->switch_count;
  ++g->switches_to[candidate];
  g->reference_low = std::min(last_load(*g), middle_load(*g));
  g->reference_high = std::max(last_load(*g), middle_load(*g));
}

}  // namespace

void start_governor(const Front& front, double budget_ns, double pixel_count, double doubt, bool load_known,
                    Governor* g) {
  CHECK_GT(front.count, 0u);
  CHECK_LE(front.count, kFrontCandidateMax);
  CHECK(budget_ns > 0 && pixel_count > 0 && doubt >= 1);
  *g = Governor();
  g->front = front;
  g->budget_ns = budget_ns;
  g->pixel_count = pixel_count;
  for (std::uint32_t i = 0; i < front.count; ++i) CHECK_GT(front.candidates[i].ns_per_pixel, 0);
  for (std::uint32_t i = 0; i < front.count; ++i) g->doubts[i] = det_log(doubt);
  g->current = g->home = load_known ? choose(*g) : fastest(*g);
  g->frames_at_current = kAttributedFrames;  // no load yet to compare with
  g->frames_to_trial = kTrialPause;
  g->trial_pause = kAgainPauseMin;
}

void set_doubt(Governor* g, std::uint32_t candidate, double doubt) {
  CHECK_LT(candidate, g->front.count);
  CHECK_GE(doubt, 1);
  g->doubts[candidate] = det_log(doubt);
}

std::uint32_t next_candidate(Governor* g) {
  if (g->load_count == 0) return g->current;
  std::uint32_t chosen = choose(*g);
  if (g->on_trial && chosen == g->current) g->trial_pause = kAgainPauseMin;  // it fits, so it stays
  bool settled = chosen == g->home && !g->on_trial && g->load_count >= kFewFrames;
  g->on_trial = false;
  g->home = chosen;
  if (settled && --g->frames_to_trial == 0) chosen = try_another(g);
  switch_to(g, chosen);
  return g->current;
}

void force_candidate(Governor* g, std::uint32_t candidate) {
  CHECK_LT(candidate, g->front.count);
  g->on_trial = false;
  switch_to(g, candidate);
}

void observe_frame(Governor* g, double frame_ns) {
  CHECK_LT(g->current, g->front.count);
  if (!(frame_ns > 0) || !std::isfinite(frame_ns)) return;
  g->late_share += ((det_log(frame_ns / g->budget_ns) > kLate ? 1 : 0) - g->late_share) / kLateFrames;
  std::uint32_t now = g->current;
  double load = det_log(frame_ns) - log_price(*g, now);
  g->ran[now] = true;
  double middle = middle_load(*g);
  std::uint32_t at = g->load_count++ % kLoadFrameCount;
  g->loads[at] = load;
  g->load_sum += load;
  if (g->load_count == 2) g->loads[0] = std::min(g->loads[0], load);  // the first frame often runs cold
  g->rises[at] = g->load_count > 1 ? load - middle : 0;
  if (g->frames_at_current++ < kAttributedFrames) attribute(g, load);
  for (std::uint32_t i = 0; i < g->front.count; ++i)
    if (g->doubts[i] < kDoubtGrown) g->doubts[i] = std::min(g->doubts[i] + kDoubtGrowth, kDoubtGrown);
  g->doubts[now] = 0;
}

double expected_ns(const Governor& g, std::uint32_t candidate) {
  CHECK_LT(candidate, g.front.count);
  return det_exp(log_price(g, candidate) + middle_load(g));
}

bool budget_too_small(const Governor& g) { return expected_ns(g, fastest(g)) > g.budget_ns; }

double learnt_price(const Governor& g, std::uint32_t candidate) {
  CHECK_LT(candidate, g.front.count);
  double load = g.load_count ? g.load_sum / g.load_count : 0;
  return static_cast<double>(g.front.candidates[candidate].ns_per_pixel) * det_exp(g.corrections[candidate] + load);
}

}  // namespace pocketray
