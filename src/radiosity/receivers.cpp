#include "radiosity/receivers.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "radiosity/corners.h"
#include "radiosity/cuts.h"

namespace pocketray {
namespace {

constexpr double kInset = 0.05;  // of a cell: nodes keep off borders
constexpr double kLift = 1e-3;   // of a cell
// Longest edge of a triangle with values at its corners, in distances of nodes. Measured: on `seesaw`, ꟻLIP is .1148
// for 1 and 1.10 MiB, .1154 for 2 and .76 MiB, .1162 for 3 and .67 MiB.
constexpr double kEdge = 2;

// Grids are finer where something stands on them: next to it, a node's distance is lost (barriers.h). Chosen.
constexpr double kFiner = 3;

// The nearest point of a triangle [Ericson 2005, sec. 5.1.5], by clamping barycentric coordinates edge by edge.
Vec3d nearest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d way = b - a;
  const double square = dot(way, way), t = square > 0 ? dot(p - a, way) / square : 0;
  return a + way * std::min(1.0, std::max(0.0, t));
}
Vec3d nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(b - a, c - a);
  const bool inside =
      dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
  if (inside) return p;
  Vec3d best = nearest_on_segment(p, a, b);
  for (const Vec3d& q : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)})
    if (length(q - p) < length(best - p)) best = q;
  return best;
}

// A point of the plane moved onto the surface; from a border towards the middle of the triangle it lies on.
Vec3d onto_surface(const Scene& scene, const FlatSurface& flat, const Vec3d& point) {
  Vec3d best = point;
  double least = 1e300;
  for (std::uint32_t t : flat.triangles) {
    const Vec3d a = corner_of(scene, t, 0), b = corner_of(scene, t, 1), c = corner_of(scene, t, 2);
    const Vec3d near = nearest_on_triangle(point, a, b, c);
    const double distance = length(near - point);
    if (distance < least) least = distance, best = near;
    if (least == 0) break;
  }
  return best;
}

// A node on the foot of a barrier is moved to one side of it.
Vec3d beside_barriers(const FlatSurface& flat, const std::vector<CutEdge>& barriers, double cell, Vec3d node) {
  for (const CutEdge& edge : barriers) {
    const Vec3d way = edge.b - edge.a, across = normalize(cross(flat.normal, way));
    const double along = dot(node - edge.a, way) / dot(way, way), off = dot(node - edge.a, across);
    if (along > -kInset && along < 1 + kInset && std::fabs(off) < 0.5 * kInset * cell)
      node += across * (kInset * cell - off);
  }
  return node;
}

void place_grid(const Scene& scene, const FlatSurface& flat, double spacing, bool back,
                const std::vector<CutEdge>& barriers, Places* places, RadiositySolution* solution) {
  auto count_of = [&](double size) {
    return std::min<std::uint32_t>(kRadiositySideMax,
                                   1 + std::max(1u, static_cast<std::uint32_t>(size / spacing + 0.75)));
  };
  const std::uint32_t columns = count_of(flat.width), rows = count_of(flat.height);
  const double step_s = flat.width / (columns - 1), step_t = flat.height / (rows - 1);
  RadiosityGrid grid;
  grid.origin = to_float(flat.origin);
  grid.along_s = to_float(flat.s / step_s), grid.along_t = to_float(flat.t / step_t);
  grid.columns = columns, grid.rows = rows;
  grid.node_begin = static_cast<std::uint32_t>(solution->nodes.size());
  const Vec3d normal = back ? -flat.normal : flat.normal;
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      auto inset = [](std::uint32_t i, std::uint32_t count) {
        return i == 0 ? kInset : i == count - 1 ? i - kInset : static_cast<double>(i);
      };
      const Vec3d wanted = beside_barriers(
          flat, barriers, std::min(step_s, step_t),
          flat.origin + flat.s * (inset(column, columns) * step_s) + flat.t * (inset(row, rows) * step_t));
      Vec3d on = onto_surface(scene, flat, wanted);
      if (on != wanted) {  // a little beyond the border, inside
        const Vec3d inward = on - wanted;
        on += inward * (kInset * std::min(step_s, step_t) / length(inward));
        on = onto_surface(scene, flat, on);
      }
      places->nodes.push_back({static_cast<std::uint32_t>(solution->nodes.size()),
                               {on, normal, kLift * std::min(step_s, step_t)},
                               flat.material});
      solution->nodes.push_back({});
    }
  const std::uint32_t index = static_cast<std::uint32_t>(solution->grids.size());
  for (std::uint32_t t : flat.triangles)
    solution->triangles[back ? scene.triangles.count + t : t] = kRadiosityGridBit | index;
  solution->grids.push_back(grid);
}

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
      std::vector<CutEdge> barriers;
      for (const CutEdge& edge : edges)
        if (is_barrier(flat, edge, surfaces.patch_side)) barriers.push_back(edge);
      place_grid(scene, flat, barriers.empty() ? spacing : spacing / kFiner, side != 0, barriers, &places, solution);
    }
  }
  return places;
}

}  // namespace pocketray
