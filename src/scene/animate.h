// Poses an animated scene at a time: node transforms, skins, morph targets [glTF 2.0, secs. 3.7.3, 3.11].
#pragma once
#include "base/arena.h"
#include "scene/scene.h"

namespace pocketray {

// What moves, at one time. The arrays start as the scene's own (time 0) and are writable copies where something moves.
struct Pose {
  Array<Vec3> positions;  // empty when no vertex moves: use Scene::positions
  Array<Vec3> normals;
  Array<Transform> nodes;  // node → world
  Array<Light> lights;     // in world space
  Array<Camera> cameras;   // in world space
};

// Bytes make_pose() takes from its arena. 0 for a scene that is not animated.
std::size_t pose_need(const Scene& scene);
// Allocates; call once. For a static scene all arrays stay empty.
Pose make_pose(const Scene& scene, Arena* arena);
// Evaluates animation `animation_index` at `seconds` (wraps at its duration) into `pose`. Allocates nothing.
void pose_at(const Scene& scene, std::uint32_t animation_index, double seconds, Pose* pose);

}  // namespace pocketray
