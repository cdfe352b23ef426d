#include "radiosity/solve.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "radiosity/bodies.h"
#include "radiosity/corners.h"
#include "radiosity/grids.h"
#include "radiosity/refine.h"
#include "radiosity/tangents.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kNodeRays = 64;
constexpr std::uint32_t kRefined = 4;  // largest ratio of numbers of patches by refinement
constexpr double kBackSees = 0.05;     // share of fronts around a back that is worth light of its own
constexpr double kCovered = 0.9;       // share of back faces around a node that lies inside a body
constexpr double kBesideBacks =
    0.5;                       // share of back faces from which on a node may lie inside, and sees none through them
constexpr double kSeen = 0.1;  // share of patches in what closes a node's surroundings, below which it lies inside, too

Outlook look_around_patch(const SceneRays& rays, const Patch& patch, std::uint32_t seed) {
  Outlook mean;
  for (int k = 0; k < kPatchSamples; ++k) {
    const Receiver at = {patch.samples[k].point, patch.samples[k].normal, patch.lift};
    const Outlook one = look_around(rays, at, kPatchRays, seed * kPatchSamples + static_cast<std::uint32_t>(k));
    mean.open += one.open / kPatchSamples;
    mean.front += one.front / kPatchSamples, mean.back += one.back / kPatchSamples;
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

// Returns the surfaces with every one stored by its triangles.
Surfaces without_grids(Surfaces surfaces) {
  surfaces.flat.clear(), surfaces.others.clear();
  for (std::uint32_t t = 0; t < surfaces.area.size(); ++t)
    if (surfaces.area[t] > 0) surfaces.others.push_back(t);
  return surfaces;
}

// Light that leaves the patches. Emission reaches pixels as direct light, except those of its own material.
struct PatchLight {
  const std::vector<Patch>& patches;
  std::vector<Vec3d> all, reflected;
};

// Returns the light arriving at a receiver of a material from all patches and from outside, as irradiance / π. Negative
// x: the receiver lies inside a body.
Vec3d gather(const SceneRays& rays, const PatchLight& light, const Receiver& at, std::uint32_t material, bool on_grid,
             std::uint32_t seed) {
  const Outlook outlook = look_around(rays, at, kNodeRays, seed);
  if (outlook.back > kCovered) return {-1, 0, 0};
  const Backs backs = on_grid && outlook.back < kBesideBacks ? Backs::hide_nothing
                      : rays.has_sheets                      ? Backs::of_bodies_hide
                                                             : Backs::hide;
  Vec3d sum = {0, 0, 0};
  double seen = 0;
  for (const Patch& patch : light.patches) {
    const double factor = patch_form_factor(at.point, at.normal, patch);
    if (!(factor > 0)) continue;
    const double share = factor * visible_share(rays, at, patch, factor, seed, backs).here;
    const std::size_t i = static_cast<std::size_t>(&patch - light.patches.data());
    sum += (patch.material == material ? light.all : light.reflected)[i] * share, seen += share;
  }
  // Surfaces fill the directions that are not open: this takes out the error of approximate factors and of visibility
  // by few rays, unless that share is the less certain.
  const double closed = outlook.front + outlook.back;
  if (closed > 0.5 && seen < kSeen * closed) return {-1, 0, 0};
  if (seen > 0) sum = sum * std::min(2.0, credible_sum(seen, closed, kNodeRays) / seen);
  return sum + to_double(rays.frame.scene->info.background) * outlook.open;
}

// Nodes inside bodies take the mean of their neighbours, from the outside in.
void fill_covered(const RadiosityGrid& grid, std::vector<char>* known, RadiosityNode* nodes) {
  const int columns = static_cast<int>(grid.columns), rows = static_cast<int>(grid.rows);
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> next = *known;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        if ((*known)[static_cast<std::size_t>(row * columns + column)]) continue;
        Vec3 sum = {0, 0, 0};
        float count = 0;
        for (int y = std::max(0, row - 1); y <= std::min(rows - 1, row + 1); ++y)
          for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x)
            if ((*known)[static_cast<std::size_t>(y * columns + x)]) sum += nodes[y * columns + x].value, ++count;
        if (count == 0) continue;
        nodes[row * columns + column].value = sum / count;
        next[static_cast<std::size_t>(row * columns + column)] = changed = true;
      }
    *known = next;
  }
}

Vec3 largest_value(const RadiositySolution& s) {
  Vec3 most = {0, 0, 0};
  for (const RadiosityNode& node : s.nodes) most = max(most, node.value);
  for (const Vec3& value : s.values) most = max(most, value);
  return most;
}

}  // namespace

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
  const Scene& scene = *frame.scene;
  const std::vector<char> bodies = find_bodies(scene);
  SceneRays rays = {frame};
  rays.bodies = &bodies;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i)
    rays.has_sheets |= !bodies[i] && !scene.materials[scene.triangles[i].material()].double_sided;
  *solution = RadiositySolution();
  const Surfaces surfaces = find_surfaces(scene, options.patch_count);
  if (!(surfaces.total_area > 0)) return failure("the scene has no surface that could reflect light");
  std::vector<Patch> patches = make_patches(scene, surfaces);
  refine_patches(rays, surfaces, kRefined * static_cast<std::uint32_t>(patches.size()), options.threads, &patches);
  uncover_patches(rays, options.threads, &patches);
  if (patches.empty()) return failure("the scene has no surface that light could reach");
  std::vector<Outlook> looks;
  add_backs(rays, options.threads, &patches, &looks);
  std::vector<double> closed, area;
  std::vector<Vec3d> albedo, first(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    closed.push_back(looks[i].front + looks[i].back), area.push_back(patches[i].area),
        albedo.push_back(patches[i].albedo);
  }
  parallel_for(static_cast<std::uint32_t>(patches.size()), options.threads, [&](std::uint32_t i) {
    const Vec3d irradiance = mean_light(rays, patches[i]);
    const bool shines = !patches[i].is_back || patches[i].double_sided;
    first[i] = (shines ? patches[i].emission : Vec3d{0, 0, 0}) +
               patches[i].albedo * (irradiance * (1 / kPi) + to_double(scene.info.background) * looks[i].open);
  });
  solution->patch_count = static_cast<std::uint32_t>(patches.size());
  constexpr double kFactorsShare = 0.3;
  const FormFactors factors = find_form_factors(rays, patches, closed, options.threads,
                                                [&](double share) { return progress(kFactorsShare * share); });
  if (factors.count != patches.size()) return failure("interrupted");
  Exchange exchange = start_exchange(area, albedo, first);
  if (!(exchange.emitted > 0)) return failure("no light reaches a surface: there is none to solve for");
  settle(factors, options.converged, 100 * factors.count, &exchange);
  solution->shots = exchange.shots;
  solution->unshot = unshot_magnitude(exchange) / exchange.emitted;
  PatchLight light_of = {patches, exchange.radiance, exchange.radiance};
  for (std::size_t i = 0; i < patches.size() && !options.stores_direct_light; ++i)
    if (!patches[i].is_back || patches[i].double_sided)
      light_of.reflected[i] = light_of.reflected[i] - patches[i].emission;

  std::vector<char> front(scene.triangles.count, 1), back(scene.triangles.count, 0);
  for (const Patch& patch : patches)
    if (patch.is_back)
      for (std::uint32_t t : patch.triangles) back[t] = 1;
  Places places = place_receivers(scene, options.stores_at_corners ? without_grids(surfaces) : surfaces, options, front,
                                  back, solution);
  std::vector<char> known(solution->nodes.size(), 1), known_values(solution->values.size(), 1);
  const std::uint32_t node_count = static_cast<std::uint32_t>(places.nodes.size());
  const std::uint32_t count = node_count + static_cast<std::uint32_t>(places.values.size());
  std::atomic<std::uint32_t> done{0};
  std::atomic<bool> stop{false};
  parallel_for(count, options.threads, [&](std::uint32_t i) {
    if (stop) return;
    const Receiver& at = i < node_count ? places.nodes[i].at : places.values[i - node_count].at;
    const std::uint32_t material = i < node_count ? places.nodes[i].material : places.values[i - node_count].material;
    Vec3d light = gather(rays, light_of, at, material, i < node_count, i);
    const bool covered = light.x < 0;
    if (options.stores_direct_light && !covered) light += light_irradiance(rays, at) * (1 / kPi);
    if (i < node_count) {
      known[places.nodes[i].node] = !covered;
      if (!covered) solution->nodes[places.nodes[i].node].value = to_float(light);
    } else {
      known_values[places.values[i - node_count].value] = !covered;
      if (!covered) solution->values[places.values[i - node_count].value] = to_float(light);
    }
    if (!progress(kFactorsShare + (1 - kFactorsShare) * ++done / count)) stop = true;
  });
  if (stop) return failure("interrupted");
  for (const RadiosityGrid& grid : solution->grids) {
    RadiosityNode* nodes = &solution->nodes[grid.node_begin];
    const auto begin = known.begin() + grid.node_begin;
    std::vector<char> of_grid(begin, begin + grid.columns * grid.rows);
    fill_covered(grid, &of_grid, nodes);
  }
  join_seams(places.seams, solution);
  for (const RadiosityGrid& grid : solution->grids)
    set_tangents(&solution->nodes[grid.node_begin], grid.columns, grid.rows, true);
  fill_covered_values(scene, &known_values, solution);
  solution->info.push_back({largest_value(*solution)});
  return success();
}

}  // namespace pocketray
