// What a sweep measures and with which rigs: both follow from the options and the scene alone.
#pragma once
#include <map>

#include "sweep/sweep.h"

namespace pocketray {

struct Rigs {
  const AccuracyOptions& options;
  std::map<std::uint32_t, std::unique_ptr<Rig>> by_columns;  // of the sphere; with kCornellSphereColumns the first
};

// Opens the first rig and plans the sweep of its scene.
Status plan_rigs(Rigs* rigs, SweepPlan* plan);

// The rig of a configuration, opened where it is not yet; it exposes as the first does. Belongs to `rigs`.
Status rig_for(Rigs* rigs, const Configuration& configuration, Rig** rig);

// The name of a point, no other's of the plan.
std::string id_of(const SweepPoint& point);

// Whether a point is measured itself: it can be had and is not the baseline under another name.
bool is_measured(const SweepPlan& plan, std::size_t point_index);

}  // namespace pocketray
