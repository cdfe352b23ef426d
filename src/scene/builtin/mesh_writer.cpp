#include "scene/builtin/mesh_writer.h"

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {

MeshWriter make_mesh(Arena* arena, MeshSize size) {
  MeshWriter mesh = make_flat_mesh(arena, size);
  mesh.normals = arena_array<Vec3>(arena, size.vertices);
  return mesh;
}

MeshWriter make_flat_mesh(Arena* arena, MeshSize size) {
  MeshWriter mesh;
  mesh.positions = arena_array<Vec3>(arena, size.vertices);
  mesh.triangles = arena_array<Triangle>(arena, size.triangles);
  return mesh;
}

void finish_mesh(const MeshWriter& mesh, Scene* scene) {
  CHECK_EQ(mesh.vertex_count, mesh.positions.count);
  CHECK_EQ(mesh.triangle_count, mesh.triangles.count);
  scene->positions = mesh.positions;
  scene->normals = mesh.normals;
  scene->triangles = mesh.triangles;
}

std::uint32_t add_vertex(MeshWriter* mesh, const Vec3& position, const Vec3& normal) {
  CHECK_LT(mesh->vertex_count, mesh->positions.count);
  mesh->positions[mesh->vertex_count] = position;
  if (mesh->normals.count)
    mesh->normals[mesh->vertex_count] = normal;
  else
    CHECK(is_zero(normal));
  return mesh->vertex_count++;
}

void add_triangle(MeshWriter* mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  CHECK_LT(mesh->triangle_count, mesh->triangles.count);
  mesh->triangles[mesh->triangle_count++] = Triangle(a, b, c, mesh->material);
}

void add_quad(MeshWriter* mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::uint32_t first = add_vertex(mesh, a, {0, 0, 0});
  add_vertex(mesh, b, {0, 0, 0});
  add_vertex(mesh, c, {0, 0, 0});
  add_vertex(mesh, d, {0, 0, 0});
  add_triangle(mesh, first, first + 1, first + 2);
  add_triangle(mesh, first, first + 2, first + 3);
}

void add_box(MeshWriter* mesh, const Vec3& low, const Vec3& high, const Transform& place) {
  static constexpr std::uint8_t kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  std::uint32_t first = mesh->vertex_count;
  for (int i = 0; i < 8; ++i) {
    Vec3 corner = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    add_vertex(mesh, transform_point(place, corner), {0, 0, 0});
  }
  for (const auto& face : kFaces) {
    add_triangle(mesh, first + face[0], first + face[1], first + face[2]);
    add_triangle(mesh, first + face[0], first + face[2], first + face[3]);
  }
}

void add_sphere(MeshWriter* mesh, const Vec3& center, const Vec3& radii, std::uint32_t columns, std::uint32_t rows) {
  CHECK_GE(columns, 3u);
  CHECK_GE(rows, 2u);
  CHECK(radii.x > 0 && radii.y > 0 && radii.z > 0);
  std::uint32_t first = add_vertex(mesh, center - Vec3{0, radii.y, 0}, {0, -1, 0});
  for (std::uint32_t row = 1; row < rows; ++row) {
    double polar = kPi * row / rows;
    double ring = det_sin(polar), height = -det_cos(polar);
    for (std::uint32_t column = 0; column < columns; ++column) {
      double azimuth = 2 * kPi * column / columns;
      Vec3 unit = {static_cast<float>(ring * det_sin(azimuth)), static_cast<float>(height),
                   static_cast<float>(ring * det_cos(azimuth))};
      Vec3 normal = normalize(Vec3{unit.x / radii.x, unit.y / radii.y, unit.z / radii.z});
      add_vertex(mesh, center + unit * radii, normal);
    }
  }
  add_vertex(mesh, center + Vec3{0, radii.y, 0}, {0, 1, 0});
  CHECK_EQ(mesh->vertex_count - first, sphere_size(columns, rows).vertices);
  add_tube_triangles(mesh, first, columns, rows - 1);
}

void add_lathe(MeshWriter* mesh, const Vec3& center, Array<const Vec2> profile, std::uint32_t columns) {
  CHECK_GE(profile.count, 2u);
  CHECK_GE(columns, 3u);
  for (std::uint32_t band = 0; band + 1 < profile.count; ++band) {
    Vec2 low = profile[band], high = profile[band + 1];
    Vec3 slope = normalize(Vec3{high.y - low.y, low.x - high.x, 0});  // outward, in the plane of the profile
    std::uint32_t first = mesh->vertex_count;
    for (std::uint32_t column = 0; column < columns; ++column) {
      double azimuth = 2 * kPi * column / columns;
      float s = static_cast<float>(det_sin(azimuth)), c = static_cast<float>(det_cos(azimuth));
      Vec3 normal = normalize(Vec3{slope.x * s, slope.y, slope.x * c});
      add_vertex(mesh, center + Vec3{low.x * s, low.y, low.x * c}, normal);
      add_vertex(mesh, center + Vec3{high.x * s, high.y, high.x * c}, normal);
    }
    for (std::uint32_t column = 0; column < columns; ++column) {
      std::uint32_t a = first + 2 * column, b = first + 2 * ((column + 1) % columns);
      if (low.x != 0) add_triangle(mesh, a, b, b + 1);
      if (high.x != 0) add_triangle(mesh, a, b + 1, a + 1);
    }
  }
}

void add_tube_triangles(MeshWriter* mesh, std::uint32_t first_vertex, std::uint32_t columns, std::uint32_t rows) {
  CHECK_GE(columns, 3u);
  CHECK_GE(rows, 1u);
  CHECK_LE(first_vertex + tube_size(columns, rows).vertices, mesh->vertex_count);
  std::uint32_t last_pole = first_vertex + 1 + columns * rows;
  for (std::uint32_t column = 0; column < columns; ++column) {
    std::uint32_t next = (column + 1) % columns;
    std::uint32_t a = first_vertex + 1 + column, b = first_vertex + 1 + next;
    add_triangle(mesh, first_vertex, b, a);
    for (std::uint32_t row = 0; row + 1 < rows; ++row, a += columns, b += columns) {
      add_triangle(mesh, a, b, b + columns);
      add_triangle(mesh, a, b + columns, a + columns);
    }
    add_triangle(mesh, a, b, last_pole);
  }
}

void smooth_normals(MeshWriter* mesh, std::uint32_t first_vertex, std::uint32_t first_triangle) {
  CHECK_LE(first_vertex, mesh->vertex_count);
  CHECK_LE(first_triangle, mesh->triangle_count);
  for (std::uint32_t v = first_vertex; v < mesh->vertex_count; ++v) mesh->normals[v] = {0, 0, 0};
  for (std::uint32_t i = first_triangle; i < mesh->triangle_count; ++i) {
    const Triangle& t = mesh->triangles[i];
    Vec3 a = mesh->positions[t.vertex(0)], b = mesh->positions[t.vertex(1)], c = mesh->positions[t.vertex(2)];
    Vec3 area = cross(b - a, c - a);
    for (std::uint32_t v : t.vertices()) mesh->normals[v] += area;
  }
  for (std::uint32_t v = first_vertex; v < mesh->vertex_count; ++v) mesh->normals[v] = normalize(mesh->normals[v]);
}

}  // namespace pocketray
