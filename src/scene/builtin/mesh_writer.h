// MeshWriter appends triangles to arrays of planned size. Every shape has a constexpr …_size(), so that a scene knows
// its exact number of vertices and triangles before it takes memory. Flat faces have zero normals (meaning the
// geometric normal), curved ones unit normals. Front faces are counter-clockwise.
#pragma once
#include "base/arena.h"
#include "scene/scene.h"

namespace pocketray {

struct MeshSize {
  std::uint32_t vertices, triangles;
};
constexpr MeshSize operator+(MeshSize a, MeshSize b) { return {a.vertices + b.vertices, a.triangles + b.triangles}; }
constexpr MeshSize operator*(std::uint32_t n, MeshSize a) { return {n * a.vertices, n * a.triangles}; }

struct MeshWriter {
  Array<Vec3> positions, normals;
  Array<Triangle> triangles;
  std::uint32_t vertex_count = 0, triangle_count = 0;  // so far
  std::uint32_t material = 0;                          // for the triangles appended next
};

constexpr std::size_t mesh_need(MeshSize size) {
  return 2 * arena_need<Vec3>(size.vertices) + arena_need<Triangle>(size.triangles);
}
MeshWriter make_mesh(Arena* arena, MeshSize size);
// A mesh of flat faces alone, which stores no normals.
constexpr std::size_t flat_mesh_need(MeshSize size) { return mesh_need(size) - arena_need<Vec3>(size.vertices); }
MeshWriter make_flat_mesh(Arena* arena, MeshSize size);
// Hands the arrays to the scene; they must be full.
void finish_mesh(const MeshWriter& mesh, Scene* scene);

std::uint32_t add_vertex(MeshWriter* mesh, const Vec3& position, const Vec3& normal);
void add_triangle(MeshWriter* mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c);

// Flat quadrilateral.
constexpr MeshSize quad_size() { return {4, 2}; }
void add_quad(MeshWriter* mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// Closed hexahedron; corner i lies at (i & 1 ? high.x : low.x, i & 2 ? high.y : …, i & 4 ? …) before `place`.
constexpr MeshSize box_size() { return {8, 12}; }
void add_box(MeshWriter* mesh, const Vec3& low, const Vec3& high, const Transform& place = {});

// Closed ellipsoid of `columns` meridian strips and `rows` bands from pole to pole.
constexpr MeshSize sphere_size(std::uint32_t columns, std::uint32_t rows) {
  return {columns * (rows - 1) + 2, 2 * columns * (rows - 1)};
}
void add_sphere(MeshWriter* mesh, const Vec3& center, const Vec3& radii, std::uint32_t columns, std::uint32_t rows);

// Surface of revolution about the y axis through `center`. The profile's points are (radius, height); from the bottom
// up, the surface faces outward. Each band between two points has its own straight normals, so profile corners stay
// sharp. Bands that start or end on the axis (radius 0) have half the triangles; `axis_ends`, 0 to 2, counts such ends.
constexpr MeshSize lathe_size(std::uint32_t columns, std::uint32_t points, std::uint32_t axis_ends) {
  return {2 * columns * (points - 1), columns * (2 * (points - 1) - axis_ends)};
}
void add_lathe(MeshWriter* mesh, const Vec3& center, Array<const Vec2> profile, std::uint32_t columns);

// Appends the triangles of a grid of columns × rows vertices that wraps around (column `columns` is column 0) and ends
// in two poles. Order of the vertices: first pole, row by row, last pole. `first_vertex` is the first pole.
constexpr MeshSize tube_size(std::uint32_t columns, std::uint32_t rows) {
  return {columns * rows + 2, 2 * columns * rows};
}
void add_tube_triangles(MeshWriter* mesh, std::uint32_t first_vertex, std::uint32_t columns, std::uint32_t rows);

// Sets the normals of vertices from `first_vertex` on to the area-weighted mean of their triangles' normals.
void smooth_normals(MeshWriter* mesh, std::uint32_t first_vertex, std::uint32_t first_triangle);

}  // namespace pocketray
