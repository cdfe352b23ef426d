// Rays that begin on the plane of a triangle: HARDCASES row 66.
#include <doctest/doctest.h>

#include "accel/variant.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// Small integers times a power of two: points of a plane, and sums of them, are exact.
Vec3 lattice_vector(Rng* rng, int size) {
  auto whole = [&] {
    return static_cast<float>(next_u32(rng) % static_cast<std::uint32_t>(2 * size + 1)) - static_cast<float>(size);
  };
  return Vec3{whole(), whole(), whole()};
}

struct OnPlane {
  Mesh mesh;
  Vec3 eye, along, across;  // on the plane of triangle 0
  float scale;
};

// A triangle and a point of its plane inside it, on its border, or beside it, `scale` times integers.
OnPlane random_on_plane(Rng* rng, float scale) {
  OnPlane p;
  p.scale = scale;
  Vec3 normal;
  do {
    p.along = lattice_vector(rng, 6), p.across = lattice_vector(rng, 6);
    if (next_u32(rng) % 3 == 0) p.along.z = p.across.z = 0;
    normal = cross(p.along, p.across);
  } while (is_zero(normal));
  p.along = p.along * scale, p.across = p.across * scale;
  p.eye = lattice_vector(rng, 1000) * scale;
  auto at = [&](int i, int k) { return p.eye + p.along * static_cast<float>(i) + p.across * static_cast<float>(k); };
  auto some = [&] { return static_cast<int>(next_u32(rng) % 41) - 20; };
  switch (next_u32(rng) % 4) {
    case 0:
      add_triangle(&p.mesh, at(some(), some()), at(some(), some()), at(some(), some()));
      break;
    case 1:
      add_triangle(&p.mesh, at(-7, -5), at(11, -4), at(1, 9));
      break;
    case 2:
      add_triangle(&p.mesh, at(0, 0), at(some(), 3), at(3, some()));
      break;
    default:
      add_triangle(&p.mesh, at(-3, 0), at(5, 0), at(some(), some()));
      break;
  }
  return p;
}

// Rays in all directions, or along the plane but for rounding.
Vec3 random_direction(Rng* rng, const OnPlane& p, bool along) {
  if (!along) return random_vec3(rng, p.scale);
  if (next_u32(rng) % 2)
    return p.along * static_cast<float>(next_u32(rng) % 9) - p.across * static_cast<float>(next_u32(rng) % 7);
  return p.along * between(rng, -1.0f, 1.0f) + p.across * between(rng, -1.0f, 1.0f);
}

// Along the direction's dominant axis, by which hits are located.
bool is_all_ahead(const Mesh& mesh, const Ray& ray) {
  const Vec3& d = ray.direction;
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (std::fabs(d[c]) >= std::fabs(d[axis])) axis = c;
  for (const Vec3& v : mesh.positions)
    if (!((v[axis] - ray.origin[axis]) * (d[axis] < 0 ? -1.0f : 1.0f) > 0)) return false;
  return true;
}

}  // namespace

// Goal: a ray that begins exactly on a triangle's plane does not hit it, on no accelerator. Method: triangles and
// points of one lattice plane, so that they are coplanar exactly, at sizes of 2^-40 to 2^40; packets of rays from
// there, also along the plane; as closest hits and as shadow rays. A ray along the plane may meet a triangle ahead of
// it edge-on, by the rounding of its direction, but never one about its origin; both kinds of rays must agree on that.
TEST_CASE("hard_66_ray_from_a_triangles_plane_does_not_hit_it") {
  std::uint64_t rays = 0, wrong = 0;
  std::vector<Variant> variants = all_variants();
  variants.push_back({&kBruteAccel, best_isa(), true});
  for (const Variant& variant : variants) {
    Rng rng = make_rng(661);
    int hits = 0, blocked = 0, differing = 0, count = 0;
    for (int i = 0; i < gate_share(400, 20000); ++i) {
      const float scale = std::ldexp(1.0f, i % 81 - 40);
      const OnPlane p = random_on_plane(&rng, scale);
      const auto world = make_world(p.mesh, variant.accel);
      Ray group[kGroupMax];
      Hit found[kGroupMax];
      const bool along = i % 2;
      for (Ray& ray : group) ray = {p.eye, random_direction(&rng, p, along), kInfinity};
      answer(variant, *world, group, kGroupMax, nullptr, found);
      for (int k = 0; k < kGroupMax; ++k, ++count) {
        const bool is_hit = found[k].triangle != kNoTriangle,
                   is_blocked = variant.accel->occluded(world->accel, group[k], nullptr, nullptr);
        differing += is_hit != is_blocked;
        if (along && is_all_ahead(p.mesh, group[k])) continue;
        hits += is_hit, blocked += is_blocked;
      }
    }
    INFO(name_of(variant));
    CHECK(hits == 0);
    CHECK(blocked == 0);
    CHECK(differing == 0);
    rays += static_cast<std::uint64_t>(count), wrong += static_cast<std::uint64_t>(hits + blocked + differing);
  }
  count_hard(rays, wrong, "no hit");
}
