// Poses an animated scene at a time: node transforms, skins, morph targets [glTF 2.0, secs. 3.7.3, 3.11, appendix C].
#pragma once
#include "base/arena.h"
#include "scene/scene.h"

namespace pocketray {

// A node's transform from the caller, which replaces its animation.
struct NodeOverride {
  Transform to_parent;
  bool on = false;
};

// The state of everything that moves at one time. All arrays are empty for a static scene; otherwise they are writable
// and as long as the scene's.
struct Pose {
  Array<Vec3> positions;                // world space; empty when no vertex moves: use Scene::positions
  Array<Vec3> normals;                  // world space; empty when no vertex moves or the scene has none
  Array<Transform> nodes;               // node → world; a hidden node has no extent
  Array<std::uint8_t> visible;          // one per node: it and all its ancestors are visible
  Array<Light> lights;                  // world space; their node is kNone
  Array<Camera> cameras;                // world space; their node is kNone
  Array<Node> local_nodes;              // as animated, relative to their parents
  Array<float> weights;                 // as animated
  Array<Material> materials;            // as animated; empty: no material is
  Array<Transform> joints;              // rest pose → world, one per Scene::joints
  Array<const NodeOverride> overrides;  // one per node, from the caller; empty: only the animation moves nodes
};

// Exact number of bytes make_pose() takes from its arena; 0 for a scene without animation.
std::size_t pose_need(const Scene& scene);
// Allocates and poses animation 0 at time 0, without overrides; call once. For a static scene all arrays stay empty.
Pose make_pose(const Scene& scene, Arena* arena);
// Evaluates animation `animation_index`, kNone for the pose at rest, at `seconds` into `pose`, overwriting it. Time
// wraps at the animation's duration, so the duration itself shows time 0. A channel holds its first key's value before
// it and its last key's value after it. A node that is not visible, or whose scale is 0 along any axis, has no volume:
// everything below it shrinks to a point, which no ray hits (HARDCASES row 70). Coordinates are clamped to
// ±kCoordinateMax, so a pose is always finite. Allocates nothing; does nothing for a static scene.
void pose_at(const Scene& scene, std::uint32_t animation_index, double seconds, Pose* pose);

// Returns whether a channel animates a material.
bool animates_materials(const Scene& scene);

}  // namespace pocketray
