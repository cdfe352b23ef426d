// Solves the indirect light of a scene at time 0: patches, their exchange of light, and what arrives at the nodes of
// the reconstruction. desktop/radiosity/ implements it: device builds have no definition.
#pragma once
#include <functional>
#include <vector>

#include "base/status.h"
#include "shade/frame_data.h"

namespace pocketray {

using SolverProgress = std::function<bool(double share)>;  // false: stop

struct RadiosityOptions {
  std::uint32_t patch_count = 1200;  // roughly
  double nodes_per_patch = 2;        // along a side, of the grids
  double converged = 1e-4;           // unshot share of the emitted light
  std::uint32_t threads = 1;
};

// The arrays of Scene.
struct RadiositySolution {
  std::vector<RadiosityInfo> info;
  std::vector<std::uint32_t> triangles;
  std::vector<RadiosityGrid> grids;
  std::vector<RadiosityNode> nodes;
  std::vector<RadiosityCorners> corners;
  std::vector<Vec3> values;
  std::vector<RadiositySplit> splits;
  std::vector<RadiosityCut> cuts;
  std::uint32_t patch_count = 0, shots = 0;
  double unshot = 0;  // share of the emitted light
  std::size_t bytes() const;
  void view(Scene* scene) const;  // the scene refers to it
};

// `frame` is prepared for time 0. `progress` may stop it, which leaves no solution.
Status solve_radiosity(const FrameData& frame, const RadiosityOptions& options, const SolverProgress& progress,
                       RadiositySolution* solution);

// Size of a solution, known without solving: the same on every machine.
struct RadiositySize {
  std::uint32_t patch_count = 0, receiver_count = 0;
  std::size_t bytes = 0;  // stored
  // Pairs of a patch and a patch or receiver that light passes between: almost all of the time.
  double pair_count() const { return static_cast<double>(patch_count) * (patch_count + double(receiver_count)); }
};

// Divides the surfaces as solve_radiosity() does, which places what is stored.
Status size_radiosity(const FrameData& frame, const RadiosityOptions& options, RadiositySize* size);

struct RadiosityForecast {
  RadiositySize size;
  double seconds = 0;  // on this machine, with the options' threads
};

// Calls size_radiosity() and times a sample of the exchange. Takes a tenth of the solution's time or less, but half a
// second where that is short.
Status forecast_radiosity(const FrameData& frame, const RadiosityOptions& options, RadiosityForecast* forecast);

// Bytes that a solution stores, from the geometry alone, without rays: as if no back saw light.
std::size_t radiosity_bytes_of_fronts(const Scene& scene, const RadiosityOptions& options);

}  // namespace pocketray
