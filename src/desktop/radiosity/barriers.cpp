#include "desktop/radiosity/barriers.h"

#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kParallel = 0.9;  // cosine between the normals of a sheet and the surface below it
constexpr double kInPlane = 1e-3;  // of a patch's side

// Returns whether a sheet stands on or hangs above a side of a surface and blocks light from it.
bool is_above(const Scene& scene, const Surfaces& surfaces, const FlatSurface& flat, std::uint32_t sheet, bool back) {
  const Material& m = scene.materials[scene.triangles[sheet].material()];
  if (surfaces.flat_of[sheet] != kNone && &surfaces.flat[surfaces.flat_of[sheet]] == &flat) return false;
  if (!is_zero(m.transmission)) return false;
  const Vec3d normal = back ? -flat.normal : flat.normal;
  Vec3d middle = {0, 0, 0};
  for (int c = 0; c < 3; ++c) middle += (corner_of(scene, sheet, c) - flat.origin) / 3.0;
  if (!(dot(middle, normal) > kInPlane * surfaces.patch_side)) return false;
  return m.double_sided || dot(surfaces.normal[sheet], normal) < kParallel;
}

// Returns whether an edge runs inside a surface's rectangle, not along its border.
bool is_inside(const FlatSurface& flat, const CutEdge& edge, double margin) {
  const Vec3d axes[2] = {flat.s, flat.t};
  const double size[2] = {flat.width, flat.height};
  for (int k = 0; k < 2; ++k) {
    const double a = dot(edge.a - flat.origin, axes[k]), b = dot(edge.b - flat.origin, axes[k]);
    if (std::fmax(a, b) < margin || std::fmin(a, b) > size[k] - margin) return false;
  }
  return true;
}

Vec3d inward_of(const Scene& scene, const FlatSurface& flat, const CutEdge& edge) {
  const Vec3d across = normalize(cross(flat.normal, edge.b - edge.a));
  double off = 0;
  for (int c = 0; c < 3; ++c) off += dot(corner_of(scene, edge.triangle, c) - edge.a, across);
  return off < 0 ? -across : across;
}

}  // namespace

std::vector<Barrier> find_barriers(const Scene& scene, const Surfaces& surfaces, const FlatSurface& flat,
                                   const std::vector<CutEdge>& edges, bool back) {
  CHECK(surfaces.patch_side > 0);
  CHECK_EQ(surfaces.flat_of.size(), scene.triangles.count);
  std::vector<Barrier> barriers;
  for (const CutEdge& edge : edges_close_to(flat, edges, surfaces.patch_side))
    if (edge.is_end && is_above(scene, surfaces, flat, edge.triangle, back) &&
        is_inside(flat, edge, kInPlane * surfaces.patch_side))
      barriers.push_back({edge.a, edge.b, inward_of(scene, flat, edge), edge.gap});
  return barriers;
}

}  // namespace pocketray
