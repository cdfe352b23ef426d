// Radiosity for scenes that store none: solved on a desktop, before memory is sealed.
#pragma once
#include <vector>

#include "session/source.h"

namespace pocketray {

// Memory of a solution that a scene's arrays refer to.
struct SolvedRadiosity {
  std::vector<std::uint8_t> memory;
  std::string summary;  // "1234 patches, 5678 shots, 0.01 % unshot"
};

// Solves the light between the surfaces of a scene at time 0 and makes the scene refer to it. Shows progress on stderr.
// Fails if the scene has no light of its own, on Ctrl-C, and in builds without the solver.
Status solve_scene(const std::string& name, std::uint32_t threads, Scene* scene, SolvedRadiosity* solved);

// If a loaded scene asks for radiosity but stores none, solves it into the scene arena.
Status solve_if_requested(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
