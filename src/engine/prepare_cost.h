// Cost of preparing a frame of a moving scene on an emulated machine: a time per moving triangle, to refit its leaf,
// and one per moving vertex. Skinned vertices count twice, those without normals a third. Fits the cycle counts of
// tests/bench/device/prepare_cost.py for four scenes of more than 3,000 triangles to within 13 %; joints are not
// counted, so small scenes with many joints take up to 1.8 times as long.
#pragma once
#include "scene/moving.h"

namespace pocketray {

struct PrepareCost {
  double triangle_ns = 0, vertex_ns = 0;
};

// 0 if no vertex moves.
inline double prepare_ns(const PrepareCost& cost, const Scene& scene) {
  if (scene.moving_meshes.empty()) return 0;
  double vertices = 0;
  for (const MovingMesh& mesh : scene.moving_meshes) vertices += mesh.vertex_count * (mesh.skin == kNone ? 1.0 : 2.0);
  if (scene.normals.empty()) vertices /= 3;
  double triangles = 0;
  for (const Triangle& triangle : scene.triangles) triangles += moves(scene.moving_meshes, triangle);
  return cost.triangle_ns * triangles + cost.vertex_ns * vertices;
}

}  // namespace pocketray
