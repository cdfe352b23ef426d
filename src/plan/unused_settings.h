// Settings that were asked for but cannot change this scene's pictures.
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

// Compares the plan of `asked` with one in which a setting has its default: a setting is unused if the effects are the
// same and none that reads it is on. Also names the effects that an interpolating setting (--selective, --resolution)
// leaves out. Settings at their defaults count as not asked for.
UnusedSettings find_unused_settings(const Scene& scene, const Settings& asked);

}  // namespace pocketray
