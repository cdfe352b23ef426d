// CRC-32 of the linear image of each built-in scene at 64×48, and of the scene itself. After an intended change of a
// scene or of the renderer, `build/test_golden` prints the new rows.
#pragma once
#include <cstdint>

namespace pocketray {

struct GoldenFrame {
  const char* scene;
  double seconds;
  std::uint32_t scene_hash, frame_hash;
};
constexpr std::uint32_t kGoldenWidth = 64, kGoldenHeight = 48;
constexpr GoldenFrame kGoldenFrames[] = {
#include "golden/frames.inc"
};

}  // namespace pocketray
