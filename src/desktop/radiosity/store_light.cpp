#include "desktop/radiosity/store_light.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/check.h"
#include "desktop/radiosity/corners.h"
#include "desktop/radiosity/grids.h"
#include "desktop/radiosity/tangents.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kNodeRays = 64;
// Where there is a sky. A window that fills a thirtieth of the hemisphere is met by 34 of them.
constexpr std::uint32_t kSkyRays = 1024;
constexpr double kCovered = 0.9;      // share of back faces around a node that lies inside a body
constexpr double kBesideBacks = 0.5;  // share from which on a node may lie inside, and sees none through them
constexpr double kSeen = 0.1;  // share of patches in what closes a node's surroundings, below which it lies inside, too

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

PatchLight light_of(const PatchSolution& solved) {
  PatchLight light = {solved.patches, solved.exchange.radiance, solved.exchange.radiance};
  for (std::size_t i = 0; i < light.patches.size(); ++i) {
    const Patch& patch = light.patches[i];
    if (!patch.is_back || patch.double_sided) light.reflected[i] = light.reflected[i] - patch.emission;
  }
  return light;
}

// Returns the light arriving at a receiver of a material from all patches and from outside, as irradiance / π. Negative
// x: the receiver lies inside a body.
Vec3d gather(const SceneRays& rays, const PatchLight& light, const Receiver& at, std::uint32_t material, bool on_grid,
             std::uint32_t seed) {
  const std::uint32_t ray_count = is_zero(rays.frame.scene->info.background) ? kNodeRays : kSkyRays;
  const Outlook outlook = look_around(rays, at, ray_count, seed);
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
  if (seen > 0) sum = sum * std::min(2.0, credible_sum(seen, closed, ray_count) / seen);
  return sum + outlook.sky;
}

Status store_light(const PatchSolution& solved, const Surfaces& surfaces, const RadiosityOptions& options,
                   const LightAt& light_at, const SolverProgress& progress, RadiositySolution* solution) {
  CHECK(solution != nullptr);
  const Scene& scene = *solved.rays.frame.scene;
  std::vector<char> front(scene.triangles.count, 1), back(scene.triangles.count, 0);
  for (const Patch& patch : solved.patches)
    if (patch.is_back)
      for (std::uint32_t t : patch.triangles) back[t] = 1;
  const Places places = place_receivers(scene, surfaces, options, front, back, solution);
  std::vector<char> known(solution->nodes.size(), 1), known_values(solution->values.size(), 1);
  const std::uint32_t node_count = static_cast<std::uint32_t>(places.nodes.size());
  const std::uint32_t count = node_count + static_cast<std::uint32_t>(places.values.size());
  std::atomic<std::uint32_t> done{0};
  std::atomic<bool> stop{false};
  parallel_for(count, options.threads, [&](std::uint32_t i) {
    if (stop) return;
    const bool on_grid = i < node_count;
    const Receiver& at = on_grid ? places.nodes[i].at : places.values[i - node_count].at;
    const std::uint32_t material = on_grid ? places.nodes[i].material : places.values[i - node_count].material;
    const Vec3d light = light_at(at, material, on_grid, i);
    const bool covered = light.x < 0;
    if (on_grid) {
      known[places.nodes[i].node] = !covered;
      if (!covered) solution->nodes[places.nodes[i].node].value = to_float(light);
    } else {
      known_values[places.values[i - node_count].value] = !covered;
      if (!covered) solution->values[places.values[i - node_count].value] = to_float(light);
    }
    if (!progress(++done / static_cast<double>(count))) stop = true;
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
