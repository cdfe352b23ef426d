// A pose in memory of its own.
#pragma once
#include <vector>

#include "scene/animate.h"

namespace pocketray {

struct Posed {
  std::vector<std::uint8_t> block;
  Pose pose;
  explicit Posed(const Scene& scene) : block(pose_need(scene) + kArenaAlignment) {
    Arena arena = make_arena("pose", block.data(), block.size());
    pose = make_pose(scene, &arena);
  }
};

}  // namespace pocketray
