#include "desktop/sweep/front.h"

#include <algorithm>

#include "base/check.h"
#include "desktop/accuracy/claim.h"
#include "desktop/accuracy/findings.h"

namespace pocketray {
namespace {

Candidate candidate_of(const Measured& m, const Settings& settings, Judge judge) {
  Candidate candidate = candidate_of(settings);
  const auto flip = [](double value) { return static_cast<float>(std::min(std::max(value, 0.0), 1.0)); };
  candidate.flip = flip(distance_to(m, judge).flip);
  if (judge == Judge::truth)
    candidate.flip888 = flip(m.flip_as[static_cast<std::size_t>(find_output_format("rgb888"))]);
  candidate.ns_per_pixel = clamped_price(m.ns_per_pixel.value);
  return candidate;
}

}  // namespace

Front front_of_sweep(const SweepPlan& plan, const Sweep& sweep) {
  CHECK_EQ(sweep.measured.size(), plan.points.size());
  std::vector<Candidate> all;
  std::vector<double> cost;
  std::vector<const Distance*> distance;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Measured& m = sweep.measured[i];
    if (!is_judged(m, sweep.judge) || !plan.points[i].is_choice) continue;
    all.push_back(candidate_of(m, plan.points[i].configuration.settings, sweep.judge));
    cost.push_back(m.ns_per_pixel.value), distance.push_back(&distance_to(m, sweep.judge));
  }
  const std::vector<bool> is_on_front = claimed_front(cost, distance);
  Front front;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (is_on_front[i] && front.count < kFrontCandidateMax) front.candidates[front.count++] = all[i];
  sort_front(&front);
  return front;
}

}  // namespace pocketray
