// CRC-32 of the linear image of each built-in scene, and of the scene itself. After an intended change of a scene or of
// the renderer, `build/test_golden` prints the new rows.
#pragma once
#include <cstdint>

#include "effect/settings.h"
#include "scene/scene.h"

namespace pocketray {

struct GoldenFrame {
  const char* scene;
  double seconds;
  std::uint32_t scene_hash, frame_hash;
};
constexpr GoldenFrame kGoldenFrames[] = {
#include "golden/frames.inc"
};

// The defaults at 64×48; at 16×12 where each pixel asks many lights.
inline Settings golden_settings(const Scene& scene) {
  Settings settings;
  settings.width = 64, settings.height = 48;
  if (scene.lights.count > 64) settings.width /= 4, settings.height /= 4;
  return settings;
}

}  // namespace pocketray
