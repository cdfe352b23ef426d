// The scenes of the comparison: their triangles and the camera that the renderer would choose.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "session/source.h"

namespace pocketray {

struct BenchScene {
  std::string name;  // as requested: "buddha", "cornell", a file
  std::unique_ptr<unsigned char[]> block;
  std::unique_ptr<Renderer> renderer;  // holds the scene
  SceneSource source;
  Camera camera;
  Box bounds;
  const Scene& scene() const { return renderer->scene; }
};

// Names of the models and built-in scenes compared by default.
const std::vector<std::string>& default_scene_names();

// Loads a scene by its name here, its built-in name or its file. Looks for models under `model_folder` and unpacks
// archives into `cache_folder` once. Succeeds with *found false if a listed model is missing.
Status load_bench_scene(const std::string& name, const std::string& model_folder, const std::string& cache_folder,
                        BenchScene* scene, bool* found);

}  // namespace pocketray
