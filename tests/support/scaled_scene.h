// A copy of a scene with every length scaled.
#pragma once
#include <memory>
#include <vector>

#include "scene/scene.h"

namespace pocketray {

struct ScaledScene {
  Scene scene;  // points at the vectors, and at the source for everything without lengths
  std::vector<Vec3> positions, rest_positions, morph_positions;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<GlassMap> glass_maps;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;
  std::vector<float> key_values;
  std::vector<Joint> joints;
  std::vector<MovingMesh> moving_meshes;

  ScaledScene() = default;
  ScaledScene(const ScaledScene&) = delete;
  void bind();  // after changing the vectors
};

// Lengths times k; radiance is unchanged, so intensities grow by k². `source` must outlive the copy, which has no baked
// accelerator.
std::unique_ptr<ScaledScene> scale_scene(const Scene& source, float k);

}  // namespace pocketray
