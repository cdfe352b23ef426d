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

// Chosen: fewer leave no shadows, more take gigabytes for form factors.
constexpr std::uint32_t kPatchCountMin = 20, kPatchCountMax = 5000;

struct RadiosityWork {
  std::uint32_t threads = 1;
  std::uint32_t patch_count = 0;  // roughly; 0: the default
};

// Returns whether this build has the solver, and the scene light of its own.
bool can_solve_radiosity(const Scene& scene);

// Solves the light between the surfaces of a scene at time 0 and makes the scene refer to it. Shows progress on stderr.
// Fails if the scene has no light of its own, on Ctrl-C, and in builds without the solver.
Status solve_scene(const std::string& name, const RadiosityWork& work, Scene* scene, SolvedRadiosity* solved);

// Predicted cost of solve_scene().
struct RadiosityCost {
  std::size_t bytes = 0;  // stored
  double seconds = 0;
};
// Predicts the cost from a sample of the work, in about a tenth of its time. The scene has light of its own. Fails in builds
// without the solver.
Status forecast_scene(std::uint32_t threads, const Scene& scene, RadiosityCost* cost);
// Predicts the stored bytes alone, in milliseconds: a lower bound, exact unless backs of surfaces see light. 0:
// unknown.
std::size_t stored_radiosity_bytes(const Scene& scene);

// Solves radiosity into the scene arena of a loaded scene.
Status solve_into(const RadiosityWork& work, const std::string& name, Renderer* renderer, SceneSource* source,
                  SceneStorage* storage);
// If a loaded scene asks for radiosity but stores none, solves it into the scene arena.
Status solve_if_requested(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
