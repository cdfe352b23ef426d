// Triangulation of polygons, for all formats with faces of more than three corners.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "desktop/import/scene_builder.h"

namespace pocketray {

// Corner n + i of a polygon of n corners: where the edge that begins at corner edges[0] meets that of edges[1].
struct PolygonCrossing {
  std::uint32_t edges[2];
  float along[2];
};
struct PolygonTriangles {
  std::vector<std::uint32_t> corners;  // three per triangle, as the polygon turns
  std::vector<PolygonCrossing> crossings;
};

// Triangulates a polygon by the even-odd rule, seen along its mean normal: also if concave, with keyholes, with corners
// on a line or coincident. All corners on the boundary are corners of triangles, so that neighbours leave no gap; one
// that repeats the previous one has a triangle without area. A polygon without area has no triangles. Returns false if
// it crosses itself more often than 64 times its number of corners.
bool triangulate_polygon(const std::vector<Vec3>& positions, PolygonTriangles* result);

// Appends the polygon of these vertices of the mesh, and vertices where it crosses itself. Three corners are appended
// as they are, fewer not at all. Polygons that cannot be triangulated are left out, with a remark.
void append_polygon(const std::vector<std::uint32_t>& vertices, MeshData* mesh, SceneBuilder* builder);

}  // namespace pocketray
