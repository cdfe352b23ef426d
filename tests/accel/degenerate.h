// Degenerate meshes: a seeded mixture of points, lines, copies and sizes from denormal to huge. All numbers are finite.
#pragma once
#include <cmath>

#include "accel/meshes.h"

namespace pocketray {

enum class Degenerate : std::uint32_t {
  one_point,      // all triangles at one point, with equal vertices
  one_vertex,     // the same with equal indices, as in `f 1 1 1`
  points,         // each triangle at its own point
  axis_line,      // on a line along an axis: boxes without surface
  other_line,     // on an oblique line
  plane,          // soup in a plane perpendicular to an axis
  copies,         // of one sound triangle
  same_centroid,  // of different sizes
  halves,         // each half the size of the one before
  sound,          // soup
  count
};

// A power of two: ordinary most of the time, otherwise as large or as small as coordinates get.
inline float random_scale(Rng* rng) {
  switch (next_u32(rng) % 8) {
    case 0:
      return 0x1p58f;
    case 1:
      return 0x1p-60f;
    case 2:
      return 0x1p-140f;  // vertices are denormal
    default:
      return std::ldexp(1.0f, static_cast<int>(next_u32(rng) % 41) - 20);
  }
}

inline void add_degenerate(Mesh* mesh, Degenerate kind, std::uint32_t count, float scale, Rng* rng) {
  Vec3 place = random_vec3(rng, scale), across = random_vec3(rng, scale);
  Vec3 p = place + random_vec3(rng, scale), q = place + random_vec3(rng, scale);
  int axis = static_cast<int>(next_u32(rng) % 3);
  std::uint32_t first = add_vertex(mesh, place);
  float size = scale;
  for (std::uint32_t i = 0; i<count; ++i, size = size> 0x1p-148f ? size * 0.5f : scale) {
    Vec3 a = random_vec3(rng, scale), b = random_vec3(rng, 0.25f * scale), c = random_vec3(rng, 0.25f * scale), line;
    line = kind == Degenerate::axis_line ? Vec3{0, 0, 0} : across;
    if (kind == Degenerate::axis_line) line[axis] = scale;
    switch (kind) {
      case Degenerate::one_vertex:
        mesh->triangles.emplace_back(first, first, first, 0);
        break;
      case Degenerate::points:
        add_triangle(mesh, a, a, a);
        break;
      case Degenerate::axis_line:
      case Degenerate::other_line:
        add_triangle(mesh, place + line * next_float(rng), place + line * next_float(rng), place);
        break;
      case Degenerate::plane:
        a[axis] = place[axis], b[axis] = c[axis] = 0;
        add_triangle(mesh, a, a + b, a + c);
        break;
      case Degenerate::copies:
        add_triangle(mesh, place, p, q);
        break;
      case Degenerate::same_centroid:
        add_triangle(mesh, a, -a, {a.x, -a.y, 0});
        break;
      case Degenerate::halves:
        add_triangle(mesh, {size, 0, -size}, {0, size, size}, {-size, -size, 0});
        break;
      case Degenerate::sound:
        add_triangle(mesh, a, a + b, a + c);
        break;
      default:
        add_triangle(mesh, place, place, place);
        break;
    }
  }
}

// The mesh of that seed: 1 … count_max triangles (every order of magnitude equally often) of one to four kinds, half of
// the meshes in shuffled order.
inline Mesh degenerate_mesh(std::uint64_t seed, std::uint32_t count_max) {
  Mesh mesh;
  Rng rng = make_rng(seed);
  double exponent = next_double(&rng) * std::log(static_cast<double>(count_max));
  std::uint32_t left = std::min(count_max, 1 + static_cast<std::uint32_t>(std::exp(exponent)));
  float scale = random_scale(&rng);
  for (std::uint32_t groups = 1 + next_u32(&rng) % 4; left > 0; --groups) {
    std::uint32_t count = groups <= 1 ? left : 1 + next_u32(&rng) % left;
    Degenerate kind = static_cast<Degenerate>(next_u32(&rng) % static_cast<std::uint32_t>(Degenerate::count));
    if (next_u32(&rng) % 3 == 0) scale = random_scale(&rng);
    add_degenerate(&mesh, kind, count, scale, &rng);
    mesh.name += (mesh.name.empty() ? "kind " : " + ") + std::to_string(static_cast<std::uint32_t>(kind)) + " x " +
                 std::to_string(count);
    left -= count;
  }
  if (next_u32(&rng) % 2)
    for (std::size_t i = mesh.triangles.size(); i > 1; --i)
      std::swap(mesh.triangles[i - 1], mesh.triangles[next_u32(&rng) % i]);
  return mesh;
}

}  // namespace pocketray
