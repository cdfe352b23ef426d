// Requested settings that cannot change this scene's pictures.
#pragma once
#include "effect/setting_list.h"
#include "scene/scene.h"

namespace pocketray {

constexpr int kUnusedNoteBytes = 256;
// Notes without the program's name, each terminated: "--compensation has no effect: …".
struct UnusedSettings {
  char notes[kSettingCount][kUnusedNoteBytes];
  int count = 0;
};

// Compares the plan of `asked` with plans in which one setting has its default: a setting is unused if the effects are
// equal and none that reads it is on. Also names the effects that an interpolating setting (--selective, --resolution)
// leaves out. Settings at their defaults count as not requested.
UnusedSettings find_unused_settings(const Scene& scene, const Settings& asked);

}  // namespace pocketray
