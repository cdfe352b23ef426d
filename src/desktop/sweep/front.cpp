#include "desktop/sweep/front.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {

Front front_of_sweep(const SweepPlan& plan, const Sweep& sweep) {
  CHECK_EQ(sweep.measured.size(), plan.points.size());
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Measured& m = sweep.measured[i];
    if (!m.missing.empty() || !plan.points[i].is_choice) continue;
    Candidate candidate = candidate_of(plan.points[i].configuration.settings);
    candidate.flip = static_cast<float>(std::min(std::max(m.flip, 0.0), 1.0));
    candidate.ns_per_pixel = clamped_price(m.ns_per_pixel.value);
    all.push_back(candidate);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.ns_per_pixel < b.ns_per_pixel; });
  Front front;
  for (const Candidate& c : all) {
    bool better =
        front.count == 0 || double(c.flip) < double(front.candidates[front.count - 1].flip) - sweep.reference_flip;
    if (better && front.count < kFrontCandidateMax) front.candidates[front.count++] = c;
  }
  sort_front(&front);
  return front;
}

}  // namespace pocketray
