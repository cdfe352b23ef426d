// The scenes of the comparison: their triangles and the camera that the renderer would choose.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "session/source.h"

namespace pocketray {

struct BenchScene {
  std::string name;  // as asked for: "buddha", "cornell", a file
  std::unique_ptr<unsigned char[]> block;
  std::unique_ptr<Renderer> renderer;  // holds the scene
  SceneSource source;
  Camera camera;
  Box bounds;
  const Scene& scene() const { return renderer->scene; }
};

// Names of the models and built-in scenes that are compared when none is asked for.
const std::vector<std::string>& default_scene_names();

// Loads a scene by its name here, its built-in name or its file. Models are looked for under `model_folder`; what lies
// there in an archive is unpacked into `cache_folder` once. `found` is false, with success, where a model of the list
// is not there.
Status load_bench_scene(const std::string& name, const std::string& model_folder, const std::string& cache_folder,
                        BenchScene* scene, bool* found);

}  // namespace pocketray
