// Flat parts of a scene, merged from triangles, each with the rectangle that its grid of nodes covers.
#pragma once
#include <numeric>
#include <vector>

#include "desktop/radiosity/form_factor.h"
#include "scene/scene.h"

namespace pocketray {

// Disjoint sets of triangles.
struct Forest {
  std::vector<std::uint32_t> parent;
  explicit Forest(std::size_t count) : parent(count) { std::iota(parent.begin(), parent.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent[find(b)] = find(a); }
};

// Plane coordinates: x = (p − origin)·s, y = (p − origin)·t; s and t are unit.
struct FlatSurface {
  std::vector<std::uint32_t> triangles;
  std::uint32_t material;
  Vec3d origin, s, t, normal;
  double width, height;  // of the rectangle from the origin
  double area;
};

struct Surfaces {
  std::vector<FlatSurface> flat;
  std::vector<std::uint32_t> others;   // triangles of no flat surface
  std::vector<std::uint32_t> flat_of;  // per triangle, or kNone
  std::vector<Vec3d> normal;           // per triangle, unit; zero without area
  std::vector<double> area;            // per triangle
  double total_area = 0;
  double patch_side = 0;
};

inline Vec3d corner_of(const Scene& scene, std::uint32_t triangle, int corner) {
  return to_double(scene.positions[scene.triangles[triangle].vertex(static_cast<std::uint32_t>(corner))]);
}

// Merges triangles that lie in a plane, have the same material and share edges, and then such parts that overlap or
// touch at T-vertices. Parts below one and a half patches are left to `others`. `patch_count` patches of equal area
// would cover all.
Surfaces find_surfaces(const Scene& scene, std::uint32_t patch_count);

}  // namespace pocketray
