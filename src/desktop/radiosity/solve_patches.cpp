#include "desktop/radiosity/solve_patches.h"

#include "base/check.h"
#include "base/fmath.h"
#include "desktop/radiosity/bodies.h"
#include "desktop/radiosity/refine.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kRefined = 4;  // largest ratio of numbers of patches by refinement
constexpr double kBackSees = 0.05;     // share of fronts around a back that is worth light of its own

Outlook look_around_patch(const SceneRays& rays, const Patch& patch, std::uint32_t seed) {
  Outlook mean;
  for (int k = 0; k < kPatchSamples; ++k) {
    const Receiver at = {patch.samples[k].point, patch.samples[k].normal, patch.lift};
    const Outlook one = look_around(rays, at, kPatchRays, seed * kPatchSamples + static_cast<std::uint32_t>(k));
    mean.open += one.open / kPatchSamples;
    mean.front += one.front / kPatchSamples, mean.back += one.back / kPatchSamples;
    mean.sky += one.sky * (1.0 / kPatchSamples);
  }
  return mean;
}

// Adds the backs of double-sided surfaces that see the front of anything, and how closed the surroundings of all are.
void add_backs(const SceneRays& rays, std::uint32_t threads, std::vector<Patch>* patches, std::vector<Outlook>* looks) {
  const std::size_t fronts = patches->size();
  std::vector<Patch> all = *patches;
  for (std::size_t i = 0; i < fronts; ++i)
    if ((*patches)[i].double_sided) all.push_back(back_of((*patches)[i]));
  std::vector<Outlook> seen(all.size());
  parallel_for(static_cast<std::uint32_t>(all.size()), threads,
               [&](std::uint32_t i) { seen[i] = look_around_patch(rays, all[i], i); });
  looks->clear(), patches->clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i >= fronts && (seen[i].front < kBackSees || seen[i].back > seen[i].front)) continue;  // or inside a body
    patches->push_back(all[i]), looks->push_back(seen[i]);
  }
}

// Light that leaves patches before any exchange: emitted, and reflected from lights and surroundings.
std::vector<Vec3d> first_light(const SceneRays& rays, const std::vector<Patch>& patches,
                               const std::vector<Outlook>& looks, std::uint32_t threads) {
  std::vector<Vec3d> first(patches.size());
  parallel_for(static_cast<std::uint32_t>(patches.size()), threads, [&](std::uint32_t i) {
    const Vec3d irradiance = mean_light(rays, patches[i]);
    const bool shines = !patches[i].is_back || patches[i].double_sided;
    first[i] =
        (shines ? patches[i].emission : Vec3d{0, 0, 0}) + patches[i].albedo * (irradiance * (1 / kPi) + looks[i].sky);
  });
  return first;
}

}  // namespace

Status divide_surfaces(const RadiosityOptions& options, PatchSolution* solved) {
  CHECK(solved != nullptr);
  SceneRays& rays = solved->rays;
  const Scene& scene = *rays.frame.scene;
  solved->bodies = find_bodies(scene);
  rays.bodies = &solved->bodies;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i)
    rays.has_sheets |= !solved->bodies[i] && !scene.materials[scene.triangles[i].material()].double_sided;
  solved->surfaces = find_surfaces(scene, options.patch_count);
  if (!(solved->surfaces.total_area > 0)) return failure("the scene has no surface that could reflect light");
  std::vector<Patch>& patches = solved->patches;
  patches = make_patches(scene, solved->surfaces);
  refine_patches(rays, solved->surfaces, kRefined * static_cast<std::uint32_t>(patches.size()), options.threads,
                 &patches);
  uncover_patches(rays, options.threads, &patches);
  if (patches.empty()) return failure("the scene has no surface that light could reach");
  add_backs(rays, options.threads, &patches, &solved->looks);
  return success();
}

Status exchange_light(const RadiosityOptions& options, const SolverProgress& progress, PatchSolution* solved) {
  CHECK(solved != nullptr && solved->looks.size() == solved->patches.size());
  const std::vector<Patch>& patches = solved->patches;
  const std::vector<Outlook>& looks = solved->looks;
  std::vector<double> closed, area;
  std::vector<Vec3d> albedo;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    closed.push_back(looks[i].front + looks[i].back), area.push_back(patches[i].area);
    albedo.push_back(patches[i].albedo);
  }
  const std::vector<Vec3d> first = first_light(solved->rays, patches, looks, options.threads);
  const FormFactors factors = find_form_factors(solved->rays, patches, closed, options.threads, progress);
  if (factors.count != patches.size()) return failure("interrupted");
  solved->exchange = start_exchange(area, albedo, first);
  if (!(solved->exchange.emitted > 0)) return failure("no light reaches a surface: there is none to solve for");
  settle(factors, options.converged, 100 * factors.count, &solved->exchange);
  return success();
}

}  // namespace pocketray
