#include "session/radiosity_solver.h"

#include "base/check.h"
#include "desktop/radiosity/store_light.h"

namespace pocketray {

std::size_t RadiositySolution::bytes() const {
  return info.size() * sizeof info[0] + triangles.size() * sizeof triangles[0] + grids.size() * sizeof grids[0] +
         nodes.size() * sizeof nodes[0] + corners.size() * sizeof corners[0] + values.size() * sizeof values[0] +
         splits.size() * sizeof splits[0] + cuts.size() * sizeof cuts[0];
}

void RadiositySolution::view(Scene* scene) const {
  auto array = [](const auto& v) {
    return Array<const std::decay_t<decltype(v[0])>>{v.data(), static_cast<std::uint32_t>(v.size())};
  };
  scene->radiosity_info = array(info), scene->radiosity_triangles = array(triangles);
  scene->radiosity_grids = array(grids), scene->radiosity_nodes = array(nodes);
  scene->radiosity_corners = array(corners), scene->radiosity_values = array(values);
  scene->radiosity_splits = array(splits), scene->radiosity_cuts = array(cuts);
}

Status solve_radiosity(const FrameData& frame, const RadiosityOptions& options, const SolverProgress& progress,
                       RadiositySolution* solution) {
  CHECK(frame.scene != nullptr && frame.geometry.accel_info != nullptr && solution != nullptr);
  CHECK_GE(options.threads, 1u);
  constexpr double kPatchesShare = 0.3;  // of the time, measured
  *solution = RadiositySolution();
  PatchSolution solved(frame);
  RETURN_IF_ERROR(divide_surfaces(options, &solved));
  solution->patch_count = static_cast<std::uint32_t>(solved.patches.size());
  RETURN_IF_ERROR(exchange_light(
      options, [&](double share) { return progress(kPatchesShare * share); }, &solved));
  solution->shots = solved.exchange.shots;
  solution->unshot = unshot_magnitude(solved.exchange) / solved.exchange.emitted;
  const PatchLight light = light_of(solved);
  return store_light(
      solved, solved.surfaces, options,
      [&](const Receiver& at, std::uint32_t material, bool on_grid, std::uint32_t seed) {
        return gather(solved.rays, light, at, material, on_grid, seed);
      },
      [&](double share) { return progress(kPatchesShare + (1 - kPatchesShare) * share); }, solution);
}

}  // namespace pocketray
