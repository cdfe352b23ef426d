// The front found by a sweep, for --budget-ms.
#pragma once
#include <string>
#include <vector>

#include "desktop/accuracy/sweep_plan.h"
#include "plan/front.h"

namespace pocketray {

struct SweptFront {
  Front front;
  std::string path;         // in the cache; empty: the scene could not be identified
  std::string prices_path;  // of the prices on this machine, likewise
};

// Returns the Pareto front of the points that can be chosen between frames on a screen of the baseline's format. Errors
// closer than the reference's own error count as equal. `sweep`: summed up from the plan's points.
Front front_of_sweep(const SweepPlan& plan, const Sweep& sweep);
// Returns the index of the front's point with this quality in the plan and in Sweep::measured.
std::size_t point_of_front(const SweepPlan& plan, const Sweep& sweep, const Quality& quality);

}  // namespace pocketray
