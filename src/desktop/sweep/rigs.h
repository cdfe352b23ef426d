// The plan of a sweep and its rigs; both depend only on the options and the scene.
#pragma once
#include <map>

#include "desktop/sweep/sweep.h"

namespace pocketray {

// Columns of cornell's sphere in references, finer than any in the sweep.
constexpr std::uint32_t kReferenceColumns = 256;

struct Rigs {
  const AccuracyOptions& options;
  std::map<std::uint32_t, std::unique_ptr<Rig>>
      by_columns;  // key: columns of the sphere; kCornellSphereColumns is the first rig
};

// Opens the first rig and plans the sweep of its scene.
Status plan_rigs(Rigs* rigs, SweepPlan* plan);

// Finds or opens the rig of a configuration, with the first rig's exposure. Owned by `rigs`.
Status rig_for(Rigs* rigs, const Configuration& configuration, Rig** rig);

// Likewise for the rig whose pictures are references.
Status reference_rig(Rigs* rigs, Rig** rig);

// Returns a unique name for a point of the plan.
std::string id_of(const SweepPoint& point);

// True if a point is measured itself: it is available and not the baseline under another name.
bool is_measured(const SweepPlan& plan, std::size_t point_index);

}  // namespace pocketray
