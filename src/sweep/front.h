// The front that a sweep found, for --budget-ms.
#pragma once
#include <string>
#include <vector>

#include "accuracy/sweep_plan.h"
#include "plan/front.h"

namespace pocketray {

struct SweptFront {
  Front front;
  std::string path;  // in the cache; empty: the scene could not be named
};

// Of all points that a screen of the baseline's format can be given between frames: those that nothing faster is more
// accurate than by more than the reference may err. `sweep`: summed up from the plan's points.
Front front_of_sweep(const SweepPlan& plan, const Sweep& sweep);

}  // namespace pocketray
