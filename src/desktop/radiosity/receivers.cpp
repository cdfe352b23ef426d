#include "desktop/radiosity/receivers.h"

#include <algorithm>

#include "base/check.h"
#include "desktop/radiosity/corners.h"
#include "desktop/radiosity/grids.h"

namespace pocketray {
namespace {

// Longest edge of a triangle with values at its corners, in distances of nodes. Measured: on `seesaw`, ꟻLIP is .1148
// for 1 and 1.10 MiB, .1154 for 2 and .76 MiB, .1162 for 3 and .67 MiB.
constexpr double kEdge = 2;

}  // namespace

Places place_receivers(const Scene& scene, const Surfaces& surfaces, const RadiosityOptions& options,
                       const std::vector<char>& front_sees, const std::vector<char>& back_sees,
                       RadiositySolution* solution) {
  CHECK(solution != nullptr);
  CHECK_EQ(front_sees.size(), scene.triangles.count);
  CHECK_EQ(back_sees.size(), scene.triangles.count);
  const bool any_back = std::find(back_sees.begin(), back_sees.end(), 1) != back_sees.end();
  solution->triangles.assign(std::size_t(scene.triangles.count) * (any_back ? 2 : 1), kNone);
  const double spacing = surfaces.patch_side / options.nodes_per_patch;
  const std::vector<CutEdge> edges = find_cut_edges(scene, surfaces);
  Places places;
  for (int side = 0; side <= (any_back ? 1 : 0); ++side) {
    const std::vector<char>& sees = side ? back_sees : front_sees;
    // Values that lie at the scene's vertices come first.
    place_corners(scene, surfaces, kEdge * spacing, side != 0, sees, &places, solution);
    for (const FlatSurface& flat : surfaces.flat) {
      const Material& m = scene.materials[flat.material];
      if (!reflects(m)) continue;
      bool any = false;
      for (std::uint32_t t : flat.triangles) any |= sees[t] != 0;
      if (!any) continue;
      const std::vector<Barrier> barriers = find_barriers(scene, surfaces, flat, edges, side != 0);
      place_grids(scene, flat, barriers, spacing, side != 0, &places, solution);
    }
  }
  return places;
}

}  // namespace pocketray
