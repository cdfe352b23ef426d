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

// Longest side of the textures from which it is solved: a device that leaves larger levels out gets the same light.
constexpr std::uint32_t kSolvedTextureSide = 256;

struct RadiosityWork {
  std::uint32_t threads = 1;
  std::uint32_t patch_count = 0;  // roughly; 0: the default
};

// Returns whether this build has the solver, and the scene light of its own.
bool can_solve_radiosity(const Scene& scene);

// Solves the light between the surfaces of a scene at time 0 and makes the scene refer to it. Shows progress on stderr.
// Fails if the scene has no light of its own, on Ctrl-C, and in builds without the solver.
Status solve_scene(const std::string& name, const RadiosityWork& work, Scene* scene, SolvedRadiosity* solved);

// Patches and bytes of a solution within a limit.
struct RadiosityLimit {
  double pair_count;  // of patches and what receives their light: bounds time, but the same on every machine
  std::uint32_t patch_count;
  std::size_t bytes;
};
struct RadiosityFit {
  std::uint32_t patch_count = 0;  // for RadiosityWork; 0: none fits
  std::size_t bytes = 0;          // stored by it, or by the coarsest
  double pair_count = 0;          // likewise
};
// Finds the finest of 1200, 300 and 75 patches whose solution stays within the limit. The scene has light of its own.
Status fit_radiosity(std::uint32_t threads, const Scene& scene, const RadiosityLimit& limit, RadiosityFit* fit);

// Predicted cost of solve_scene().
struct RadiosityCost {
  std::size_t bytes = 0;  // stored
  double seconds = 0;
};
// Predicts the cost from a sample of the work, in about a tenth of its time. The scene has light of its own. Fails in
// builds without the solver.
Status forecast_scene(std::uint32_t threads, const Scene& scene, RadiosityCost* cost);
// Predicts the stored bytes alone, in milliseconds: a lower bound, exact unless backs of surfaces see light. 0:
// unknown.
std::size_t stored_radiosity_bytes(const Scene& scene);

constexpr int kRadiosityArrays = 8;
// Calls visit(array) for each array of a scene's radiosity.
template <class Visit>
void visit_radiosity(Scene* s, const Visit& visit) {
  visit(s->radiosity_info), visit(s->radiosity_triangles), visit(s->radiosity_grids);
  visit(s->radiosity_nodes), visit(s->radiosity_corners), visit(s->radiosity_values), visit(s->radiosity_splits);
  visit(s->radiosity_cuts);
}
// Makes the scene store no radiosity.
void drop_radiosity(Scene* scene);

// Solves radiosity into the scene arena of a loaded scene.
Status solve_into(const RadiosityWork& work, const std::string& name, Renderer* renderer, SceneSource* source,
                  SceneStorage* storage);
// Copies the radiosity of `lit`, whose arrays lie in `solved`, into the scene arena of a loaded scene.
Status adopt_radiosity(const std::string& name, const Scene& lit, const SolvedRadiosity& solved, Renderer* renderer,
                       SceneSource* source, SceneStorage* storage);
// If a loaded scene asks for radiosity but stores none, solves it into the scene arena.
Status solve_if_requested(const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage);

}  // namespace pocketray
