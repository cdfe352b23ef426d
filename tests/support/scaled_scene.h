// A scene copied with every length in it multiplied.
#pragma once
#include <memory>
#include <vector>

#include "scene/scene.h"

namespace pocketray {

struct ScaledScene {
  Scene scene;  // shows the vectors, and the source for all that has no length in it
  std::vector<Vec3> positions, rest_positions, morph_positions;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;
  std::vector<float> key_values;
  std::vector<Joint> joints;
  std::vector<MovingMesh> moving_meshes;

  ScaledScene() = default;
  ScaledScene(const ScaledScene&) = delete;
  void bind();  // after the vectors have changed
};

// Lengths times k; radiance stays what it is, so intensities grow by k². `source` has to outlive the copy, which has no
// baked accelerator.
std::unique_ptr<ScaledScene> scale_scene(const Scene& source, float k);

}  // namespace pocketray
