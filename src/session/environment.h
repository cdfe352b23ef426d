// --environment: light from all directions for a scene, by name.
#pragma once
#include <string>
#include <vector>

#include "session/source.h"

namespace pocketray {

// Memory that a scene with a new environment refers to.
struct EnvironmentMemory {
  std::vector<EnvironmentInfo> info;
  std::vector<std::uint32_t> texels;
  std::vector<Light> lights;
  std::vector<EnvironmentSun> suns;
  std::string file;  // it was read from; empty: none
};

// Gives the scene the named environment (import/environment.h) in place of its background, ambient term and, unless it
// is the studio, default lights, and adds the environment's lights. `memory` must outlive the scene. Fails in builds
// without importers.
Status set_environment(const std::string& name, Scene* scene, EnvironmentMemory* memory);

// Likewise for a loaded scene, with memory from the scene arena; does nothing if the name is empty or kNoEnvironment.
Status set_environment_if_requested(const std::string& name, Renderer* renderer, SceneSource* source,
                                    SceneStorage* storage);

}  // namespace pocketray
