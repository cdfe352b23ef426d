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
  Front front;
  for (const Measured* m : front_of(sweep, sweep.judge)) {
    if (front.count == kFrontCandidateMax) break;
    const std::size_t point = static_cast<std::size_t>(m - sweep.measured.data());
    front.candidates[front.count++] = candidate_of(*m, plan.points[point].configuration.settings, sweep.judge);
  }
  sort_front(&front);
  return front;
}

std::size_t point_of_front(const SweepPlan& plan, const Sweep& sweep, const Quality& quality) {
  CHECK_EQ(sweep.measured.size(), plan.points.size());
  for (const Measured* m : front_of(sweep, sweep.judge)) {
    const std::size_t point = static_cast<std::size_t>(m - sweep.measured.data());
    if (same_quality(plan.points[point].configuration.settings, quality)) return point;
  }
  CHECK(false);  // the front has no such point
  return 0;
}

}  // namespace pocketray
