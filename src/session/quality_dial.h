// Levels of quality between which a viewer switches.
#pragma once
#include "plan/quality_level.h"
#include "session/open_scene.h"

namespace pocketray {

struct QualityDial {
  Quality levels[kQualityLevelCount];
  QualityLevel current = QualityLevel::medium;
  int steps = 0;  // turned so far
};

// Opens the scene as open_scene() and start_scene() do, with memory for as many levels, from draft up, as fit without a
// slower accelerator. Settings given on the command line are equal in all levels.
Status open_scene_with_dial(const CommonOptions& common, const std::function<OutputNeed(const Settings&)>& output_bytes,
                            OpenScene* opened, QualityDial* dial);

// Turns the dial by so many levels and changes the renderer's settings for the next frames. Fails and changes nothing
// if there is no such level or no memory for it.
Status turn_dial(QualityDial* dial, int steps, Renderer* renderer);

}  // namespace pocketray
