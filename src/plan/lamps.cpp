#include "plan/lamps.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/limits.h"

namespace pocketray {
namespace {

static_assert(kDividedLampsMax * kPointsPerAreaLightMax <= kPointLightCountMax, "all lamps, with all points");

constexpr double kUnevenMax = 0x1p-12;  // maximum deviation of a piece from its plane, relative to its size

Vec3d corner(const Scene& scene, std::uint32_t triangle, std::uint32_t i) {
  return to_double(scene.positions[scene.triangles[triangle].vertex(i)]);
}

Vec3d area_vector(const Scene& scene, std::uint32_t triangle) {
  const Vec3d a = corner(scene, triangle, 0);
  return cross(corner(scene, triangle, 1) - a, corner(scene, triangle, 2) - a);
}

// Height of a point over a triangle's plane, relative to the larger of its distance and the triangle's size.
double height_over(const Scene& scene, std::uint32_t triangle, const Vec3d& point) {
  const Vec3d normal = area_vector(scene, triangle), offset = point - corner(scene, triangle, 0);
  const double area = length(normal);
  return dot(offset, normal) / area / std::max(length(offset), std::sqrt(area));
}

// Returns whether a triangle lies in another's plane and faces the same way.
bool is_in_plane(const Scene& scene, std::uint32_t piece, std::uint32_t triangle) {
  if (!(dot(area_vector(scene, piece), area_vector(scene, triangle)) > 0)) return false;
  for (std::uint32_t i = 0; i < 3; ++i)
    if (!(std::fabs(height_over(scene, piece, corner(scene, triangle, i))) <= kUnevenMax)) return false;
  return true;
}

bool rests(const Scene& scene, std::uint32_t triangle) {
  const std::uint32_t vertex = scene.triangles[triangle].vertex(0);
  for (const MovingMesh& mesh : scene.moving_meshes)
    if (vertex >= mesh.vertex_begin && vertex - mesh.vertex_begin < mesh.vertex_count) return false;
  return true;
}

// Returns whether no triangle of the material reaches above the plane of any piece.
bool is_convex(const Scene& scene, const Lamp* pieces, std::uint32_t count) {
  for (std::uint32_t p = 0; p < count; ++p) {
    for (std::uint32_t t = pieces[0].begin; t < scene.triangles.count; ++t) {
      if (scene.triangles[t].material() != pieces[p].material) continue;
      for (std::uint32_t i = 0; i < 3; ++i)
        if (height_over(scene, pieces[p].piece, corner(scene, t, i)) > kUnevenMax) return false;
    }
  }
  return true;
}

// Adds the pieces of a material that is to be divided. Returns the number of lamps that it becomes.
std::uint32_t divide(const Scene& scene, std::uint32_t material, LampPieces* all) {
  CHECK(all != nullptr);
  Lamp pieces[kPiecesMax];
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (scene.triangles[i].material() != material || is_zero(area_vector(scene, i))) continue;
    Lamp* piece = std::find_if(pieces, pieces + count, [&](const Lamp& p) { return is_in_plane(scene, p.piece, i); });
    if (piece == pieces + count) {
      if (count == kPiecesMax || !rests(scene, i)) return 1;
      pieces[count++] = {material, i, i, i};
    }
    piece->end = i + 1;
  }
  if (count < 2 || (count > kConvexPiecesMax && is_convex(scene, pieces, count))) return 1;
  if (all->count + count <= kDividedLampsMax) std::copy(pieces, pieces + count, all->piece + all->count);
  all->count += count;
  return count;
}

}  // namespace

Lamp undivided_lamp(const Scene& scene, std::uint32_t material) {
  CHECK_LT(material, scene.materials.count);
  Lamp lamp = {material, kNone, 0, 0};
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (scene.triangles[i].material() != material) continue;
    if (lamp.end == 0) lamp.begin = i;
    lamp.end = i + 1;
  }
  return lamp;
}

bool is_of_piece(const Scene& scene, const Lamp& lamp, std::uint32_t triangle) {
  CHECK_LE(lamp.end, scene.triangles.count);
  CHECK_LT(lamp.piece, scene.triangles.count);
  return lamp.piece == triangle || is_in_plane(scene, lamp.piece, triangle);
}

LampPieces find_lamp_pieces(const Scene& scene, Array<const Material> materials) {
  CHECK_EQ(materials.count, scene.materials.count);
  LampPieces pieces;
  std::uint32_t count = 0;
  for (std::uint32_t m = 0; m < materials.count && count <= kDividedLampsMax; ++m)
    if (is_emissive(materials[m])) count += divide(scene, m, &pieces);
  if (count > kDividedLampsMax) pieces.count = 0;
  CHECK_LE(pieces.count, kDividedLampsMax);
  return pieces;
}

}  // namespace pocketray
