// Generated meshes for the accelerator suites.
#pragma once
#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/rng.h"
#include "scene/scene.h"

namespace pocketray {

struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

inline float between(Rng* rng, float low, float high) { return low + (high - low) * next_float(rng); }
inline Vec3 random_vec3(Rng* rng, float size) {
  float x = between(rng, -size, size), y = between(rng, -size, size);
  return {x, y, between(rng, -size, size)};
}

inline std::uint32_t add_vertex(Mesh* mesh, const Vec3& p) {
  mesh->positions.push_back(p);
  return static_cast<std::uint32_t>(mesh->positions.size() - 1);
}
inline void add_triangle(Mesh* mesh, const Vec3& a, const Vec3& b, const Vec3& c) {
  std::uint32_t first = add_vertex(mesh, a);
  add_vertex(mesh, b), add_vertex(mesh, c);
  mesh->triangles.emplace_back(first, first + 1, first + 2, 0);
}

inline Mesh soup(const char* name, int count, float spread, float size, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = name;
  Rng rng = make_rng(seed);
  for (int i = 0; i < count; ++i) {
    Vec3 p = random_vec3(&rng, spread);
    add_triangle(&mesh, p, p + random_vec3(&rng, size), p + random_vec3(&rng, size));
  }
  return mesh;
}

inline Mesh scaled(const char* name, Mesh mesh, float factor) {
  mesh.name = name;
  for (Vec3& p : mesh.positions) p = p * factor;
  return mesh;
}

inline Mesh coplanar() {
  Mesh mesh;
  mesh.name = "coplanar";
  Rng rng = make_rng(11);
  for (int i = 0; i < 300; ++i) {
    Vec3 p = random_vec3(&rng, 1), q = random_vec3(&rng, 0.5f), r = random_vec3(&rng, 0.5f);
    p.y = 0.25f, q.y = r.y = 0;
    add_triangle(&mesh, p, p + q, p + r);
  }
  return mesh;
}

inline Mesh slivers() {
  Mesh mesh;
  mesh.name = "slivers";
  Rng rng = make_rng(12);
  for (int i = 0; i < 300; ++i) {
    Vec3 p = random_vec3(&rng, 1), q = random_vec3(&rng, 1);
    add_triangle(&mesh, p, p + q, p + q * 0.5f + random_vec3(&rng, 1e-6f));
  }
  return mesh;
}

// Boxes nested by 2^-i: these drive the depth of a tree.
inline Mesh nested(const char* name, int count, float first) {
  Mesh mesh;
  mesh.name = name;
  float s = first;
  for (int i = 0; i < count; ++i, s *= 0.5f) add_triangle(&mesh, {s, 0, -s}, {0, s, s}, {-s, -s, 0});
  return mesh;
}

inline Mesh duplicates(const char* name, int count) {
  Mesh mesh;
  mesh.name = name;
  for (int i = 0; i < count; ++i) add_triangle(&mesh, {-1, -1, 0}, {1, -1, 0.5f}, {0, 1, 0});
  return mesh;
}

inline Mesh degenerates() {
  Mesh mesh = soup("degenerates", 100, 1, 0.5f, 13);
  Rng rng = make_rng(14);
  for (int i = 0; i < 100; ++i) {
    Vec3 p = random_vec3(&rng, 1), q = {1, 0.5f, -0.25f};
    add_triangle(&mesh, p, p, i % 2 ? p : p + q);
    add_triangle(&mesh, {0, 0, 0}, q, q * 2.0f);
  }
  return mesh;
}

// A closed, jittered sphere of 20·4^level triangles about `center`.
inline Mesh jittered_sphere(int level, float radius, const Vec3& center, float jitter, std::uint64_t seed) {
  const float g = 1.6180339887f;
  std::vector<Vec3> points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::uint32_t, 3>> faces = {
      {{0, 11, 5}},  {{0, 5, 1}},  {{0, 1, 7}},  {{0, 7, 10}}, {{0, 10, 11}}, {{1, 5, 9}}, {{5, 11, 4}},
      {{11, 10, 2}}, {{10, 7, 6}}, {{7, 1, 8}},  {{3, 9, 4}},  {{3, 4, 2}},   {{3, 2, 6}}, {{3, 6, 8}},
      {{3, 8, 9}},   {{4, 9, 5}},  {{2, 4, 11}}, {{6, 2, 10}}, {{8, 6, 7}},   {{9, 8, 1}}};
  for (; level > 0; --level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    auto middle = [&](std::uint32_t a, std::uint32_t b) {
      auto added = middles.insert({{std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(points.size())});
      if (added.second) points.push_back(normalize(points[a]) + normalize(points[b]));
      return added.first->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& f : faces) {
      std::uint32_t a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      finer.push_back({{f[0], a, c}}), finer.push_back({{f[1], b, a}});
      finer.push_back({{f[2], c, b}}), finer.push_back({{a, b, c}});
    }
    faces = finer;
  }
  Mesh mesh;
  mesh.name = "sphere";
  Rng rng = make_rng(seed);
  for (const Vec3& p : points)
    add_vertex(&mesh, center + normalize(p) * (radius * (1 + between(&rng, -jitter, jitter))));
  for (const auto& f : faces) mesh.triangles.emplace_back(f[0], f[1], f[2], 0);
  return mesh;
}

// A closed box of 6·n·n squares on integer coordinates from 0 to n.
inline Mesh lattice_box(int n) {
  Mesh mesh;
  mesh.name = "lattice";
  std::map<std::array<int, 3>, std::uint32_t> known;
  auto vertex = [&](int axis, int side, int i, int j) {
    std::array<int, 3> p;
    p[axis] = side, p[(axis + 1) % 3] = i, p[(axis + 2) % 3] = j;
    auto added = known.insert({p, static_cast<std::uint32_t>(mesh.positions.size())});
    if (added.second) mesh.positions.push_back({float(p[0]), float(p[1]), float(p[2])});
    return added.first->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side <= n; side += n)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          std::uint32_t a = vertex(axis, side, i, j), b = vertex(axis, side, i + 1, j),
                        c = vertex(axis, side, i + 1, j + 1), d = vertex(axis, side, i, j + 1);
          mesh.triangles.emplace_back(a, b, c, 0), mesh.triangles.emplace_back(a, c, d, 0);
        }
  return mesh;
}

// Meshes of every awkward kind.
inline std::vector<Mesh> generated_meshes() {
  std::vector<Mesh> meshes;
  meshes.push_back(Mesh{"nothing", {}, {}});
  meshes.push_back(soup("one", 1, 0.1f, 1, 1));
  meshes.push_back(soup("five", 5, 0.5f, 1, 2));
  meshes.push_back(soup("small soup", 600, 1, 0.1f, 3));
  meshes.push_back(soup("large soup", 200, 1, 2, 4));
  meshes.push_back(lattice_box(8));
  meshes.push_back(jittered_sphere(2, 1, {0, 0, 0}, 0.05f, 5));
  meshes.push_back(coplanar());
  meshes.push_back(slivers());
  meshes.push_back(nested("nested", 60, 1));
  meshes.push_back(duplicates("duplicates", 100));
  meshes.push_back(degenerates());
  meshes.push_back(scaled("huge", soup("", 300, 1, 0.5f, 6), 4e17f));
  meshes.push_back(scaled("tiny", soup("", 300, 1, 0.5f, 7), 1e-15f));
  meshes.push_back(scaled("minute", soup("", 300, 1, 0.5f, 9), 1e-25f));
  meshes.push_back(scaled("denormal", soup("", 60, 1, 0.5f, 8), 1e-40f));
  return meshes;
}

}  // namespace pocketray
