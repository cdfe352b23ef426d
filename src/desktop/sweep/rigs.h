// The plan of a sweep and its rigs; both depend only on the options and the scene.
#pragma once
#include <map>

#include "desktop/sweep/sweep.h"

namespace pocketray {

// Columns of cornell's sphere in references, finer than any in the sweep.
constexpr std::uint32_t kReferenceColumns = 256;

struct Rigs {
  const AccuracyOptions& options;
  std::map<std::string, std::unique_ptr<Rig>> by_scene;  // key: see key_of()
  BakeableScene bakeable = {};                           // if the options ask for it
};

// Returns a unique name for a choice of scenes.
std::string key_of(const SceneChoice& choice);
SceneChoice scene_of(const Configuration& configuration);
// Returns the rig of the baseline, which plan_rigs() opened.
Rig* first_rig(const Rigs& rigs);

// Opens the first rig and plans the sweep of its scene.
Status plan_rigs(Rigs* rigs, SweepPlan* plan);

// Finds or opens the rig of a configuration, with the first rig's exposure. Owned by `rigs`.
Status rig_for(Rigs* rigs, const Configuration& configuration, Rig** rig);

// Finds or opens the rig that renders references, as above: its sphere in cornell is finer, and where textures are
// varied, they are the largest.
Status reference_rig(Rigs* rigs, Rig** rig);

// Closes a rig that is no longer used, unless it is the first.
void close_rig(Rigs* rigs, const Rig* rig);

// Returns a unique name for a point of the plan.
std::string id_of(const SweepPoint& point);

// True if a point is measured itself: it is available and not the baseline under another name.
bool is_measured(const SweepPlan& plan, std::size_t point_index);

}  // namespace pocketray
