#include "desktop/accuracy/sum_up.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/findings.h"

namespace pocketray {
namespace {

constexpr const char* kSentNote = "as shown after the codec; the time is of tracing, without a server";

// Times of finished rounds relative to the baseline's in the same round, whose runs share the machine's state.
std::vector<double> ratios_of(const PointFigures& f, const PointFigures& baseline) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(f.ns_per_pixel.size(), baseline.ns_per_pixel.size()); ++i)
    ratios.push_back(f.ns_per_pixel[i] / baseline.ns_per_pixel[i]);
  return ratios;
}

Measured measured_of(const SweepPoint& point, const PointFigures& f, const PointFigures& baseline) {
  Measured m;
  m.knob = point.knob, m.value = point.value, m.is_default = point.is_default, m.missing = point.missing;
  m.indirect = point.indirect, m.is_choice = point.is_choice;
  if (!m.missing.empty()) return m;
  if (!f.has_errors || f.ns_per_pixel.empty()) {
    m.missing = "not measured yet";
    return m;
  }
  if (point.configuration.near_lossless) m.note = kSentNote;
  m.time_ratio = median_interval(ratios_of(f, baseline));
  m.ns_per_pixel = median_interval(f.ns_per_pixel);
  m.ns_per_pixel.value = m.time_ratio.value * median(baseline.ns_per_pixel);
  m.ns_per_pixel.low = std::min(m.ns_per_pixel.low, m.ns_per_pixel.value);
  m.ns_per_pixel.high = std::max(m.ns_per_pixel.high, m.ns_per_pixel.value);
  m.instructions_per_pixel = f.instructions_per_pixel, m.bytes_per_frame = f.bytes_per_frame;
  m.stored_bytes = f.stored_bytes, m.bake_seconds = f.bake_seconds;
  m.truth = f.truth, m.model = f.model, m.flip_before = f.flip_before, m.flip_as = f.flip_as, m.errors = f.errors;
  return m;
}

// Finds the slope in each round and how far the medians are from the law. `points`: indices in the plan, the best last.
void find_slope(const std::vector<PointFigures>& figures, const std::vector<std::size_t>& points, const Sweep& sweep,
                KnobFigures* k) {
  std::vector<double> errors, medians, slopes;
  for (std::size_t i : points) {
    errors.push_back(sweep.measured[i].errors.rmse), medians.push_back(sweep.measured[i].time_ratio.value);
    if (!(errors.back() * errors.back() + sweep.model.rmse > 0)) return;  // no relative difference is defined
  }
  double resolution = kClaimFactor * sweep.model.rmse;
  std::size_t rounds = figures[0].ns_per_pixel.size();
  CHECK_GE(points.size(), 4u);
  for (std::size_t i : points) rounds = std::min(rounds, figures[i].ns_per_pixel.size());
  for (std::size_t round = 0; round < rounds; ++round) {
    std::vector<double> times;
    for (std::size_t i : points) times.push_back(figures[i].ns_per_pixel[round] / figures[0].ns_per_pixel[round]);
    slopes.push_back(fit_power_law(times, errors, resolution).exponent);
  }
  k->slope = median_interval(slopes);
  k->slope_misfit = fit_power_law(medians, errors, resolution).misfit;
  k->has_slope = std::isfinite(k->slope.value) && k->slope.value < 0;
}

KnobFigures figures_of(const SweptKnob& swept, const SweepPlan& plan, const std::vector<PointFigures>& figures,
                       const Sweep& sweep) {
  CHECK(swept.knob != nullptr);
  CHECK_LE(swept.first + swept.count, sweep.measured.size());
  const Knob& knob = *swept.knob;
  KnobFigures k;
  k.name = knob.name, k.what = knob.what, k.effect = knob.effect, k.theory = knob.theory;
  k.judge = judge_of(knob), k.is_baked = is_bake_choice(knob);
  const Measured *worst = nullptr, *best = nullptr;
  bool one_renderer = true;
  std::size_t best_index = 0;
  for (std::size_t i = swept.first; i < swept.first + swept.count; ++i) {
    const Measured& m = sweep.measured[i];
    if (!m.missing.empty()) continue;
    worst = worst ? worst : &m;
    best = &m, best_index = i;
    one_renderer = one_renderer && m.note.empty();
  }
  std::vector<std::size_t> faster;
  for (std::size_t i = swept.first; best && i < swept.first + swept.count; ++i) {
    const Measured& m = sweep.measured[i];
    if (!m.missing.empty() || m.time_ratio.value >= best->time_ratio.value) continue;
    double own = m.errors.rmse * m.errors.rmse - best->errors.rmse * best->errors.rmse;
    if (own > std::pow(kClaimFactor * sweep.model.rmse, 2)) faster.push_back(i);
  }
  if (k.judge == Judge::model && knob.labels.empty() && faster.size() >= 3) {
    faster.push_back(best_index);
    for (std::size_t& i : faster) i = plan.points[i].is_default ? 0 : i;
    find_slope(figures, faster, sweep, &k);
  }
  if (!worst || !one_renderer) return k;
  const Distance &from = distance_to(*worst, k.judge), &to = distance_to(*best, k.judge);
  if (is_nearer(from, to))
    k.ms_per_flip = (best->ns_per_pixel.value - worst->ns_per_pixel.value) * 1e-6 * sweep.width * sweep.height * 0.01 /
                    (from.flip - to.flip);
  return k;
}

}  // namespace

void sum_up(const SweepPlan& plan, const std::vector<PointFigures>& figures, Sweep* sweep) {
  CHECK_EQ(plan.points.size(), figures.size());
  sweep->measured.clear();
  sweep->knobs.clear();
  for (std::size_t i = 0; i < plan.points.size(); ++i)
    sweep->measured.push_back(measured_of(plan.points[i], figures[plan.points[i].is_default ? 0 : i], figures[0]));
  for (const Measured* m : front_of(*sweep, sweep->judge))
    sweep->measured[static_cast<std::size_t>(m - sweep->measured.data())].pareto = true;
  for (Measured& m : sweep->measured)
    if (m.is_default) m.pareto = sweep->measured.front().pareto;
  for (const SweptKnob& swept : plan.knobs) sweep->knobs.push_back(figures_of(swept, plan, figures, *sweep));
}

}  // namespace pocketray
