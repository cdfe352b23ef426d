#include <doctest/doctest.h>

#include "accel/accel_world.h"

using namespace pocketray;

namespace {

// A ray about the mesh: from outside or inside, at a random point, a vertex, an edge or along an axis.
Ray ray_about(Rng* rng, const Mesh& mesh, const Box& bounds) {
  Vec3 middle = is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds);
  float size = is_empty(bounds) ? 1.0f : max_component(extent(bounds));
  Vec3 origin = middle + random_vec3(rng, size * (next_u32(rng) % 2 ? 2.0f : 0.6f));
  Vec3 target = middle + random_vec3(rng, size * 0.6f);
  if (!mesh.triangles.empty() && next_u32(rng) % 4 != 0) {
    const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
    Vec3 a = mesh.positions[t.vertex[0]], b = mesh.positions[t.vertex[1]];
    target = next_u32(rng) % 2 ? a : a + (b - a) * next_float(rng);
    if (next_u32(rng) % 8 == 0) origin = a;
    if (next_u32(rng) % 4 == 0) {
      int axis = static_cast<int>(next_u32(rng) % 3);
      float along = origin[axis];
      origin = target, origin[axis] = along;
    }
  }
  return {origin, target - origin, next_u32(rng) % 4 ? kInfinity : 0.9f};
}

}  // namespace

// Goal: every accelerator gives the same bits as brute force, on meshes of every kind. Method: differential, with rays
// that aim at vertices and edges, start on them, run along the axes.
TEST_CASE("accel_hits_are_those_of_brute_force") {
  for (const Mesh& mesh : generated_meshes()) {
    auto oracle = make_world(mesh, &kBruteAccel);
    for (const AccelInfo* info : kAccelList) {
      auto world = make_world(mesh, info);
      Rng rng = make_rng(101);
      int wrong = 0, hits = 0;
      for (int i = 0; i < 3000; ++i) {
        Ray ray = ray_about(&rng, mesh, oracle->accel.bounds);
        Hit expected = closest(*oracle, ray), found = closest(*world, ray);
        wrong += !same_hit(expected, found);
        wrong += world->info->occluded(world->accel, ray, nullptr, nullptr) != (expected.triangle != kNoTriangle);
        hits += expected.triangle != kNoTriangle;
      }
      INFO(mesh.name << ", " << info->name << ", " << hits << " hits");
      CHECK(wrong == 0);
    }
  }
}
