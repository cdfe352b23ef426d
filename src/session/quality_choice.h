// Translates levels of quality into settings for a scene.
#pragma once
#include "plan/quality_level.h"
#include "session/scene_options.h"

namespace pocketray {

struct LevelMeaning {
  Candidate candidate;       // with its error and price if it is measured
  bool is_measured = false;  // a point of the scene's front in the cache; otherwise built in
  bool is_priced = false;    // on this machine, emulated or not; otherwise where the front was measured
};

// Reads the levels of a scene between load_scene() and plan_renderer(), for which `renderer` holds it; adds the camera
// and lights that it lacks.
void find_levels(const std::string& scene, const SceneSource& source, Renderer* renderer,
                 LevelMeaning (&levels)[kQualityLevelCount]);

// Settings of each level, except those given on the command line. The renderer must hold the scene.
Status find_level_settings(const CommonOptions& options, const SceneSource& source, Renderer* renderer,
                           Quality (&settings)[kQualityLevelCount]);

// Sets what --quality asks for, except the settings given on the command line.
Status set_quality(const CommonOptions& options, const SceneSource& source, Renderer* renderer);

}  // namespace pocketray
