#include "accel/denormals.h"

#include <doctest/doctest.h>

#include <cmath>

#include "accel/variant.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// Mostly plain numbers, but also zeros and magnitudes around those where products and differences become denormal.
float awkward(Rng* rng, int exponent_min) {
  std::uint32_t kind = next_u32(rng) % 8;
  float x = between(rng, -1, 1);
  if (kind == 0) return 0;
  if (kind < 4) return x;
  return std::ldexp(std::copysign(1 + std::fabs(x), x),
                    -static_cast<int>(next_u32(rng) % static_cast<std::uint32_t>(-exponent_min)));
}
Vec3 awkward3(Rng* rng, int exponent_min) {
  float x = awkward(rng, exponent_min), y = awkward(rng, exponent_min);
  return {x, y, awkward(rng, exponent_min)};
}

Mesh awkward_mesh(Rng* rng, int exponent_min) {
  Mesh mesh;
  Vec3 corner[40];
  for (Vec3& p : corner) p = awkward3(rng, exponent_min);
  for (int n = 0; n < 60; ++n) {
    const Vec3 &a = corner[next_u32(rng) % 40], &b = corner[next_u32(rng) % 40];
    add_triangle(&mesh, a, b, corner[next_u32(rng) % 40]);
  }
  return mesh;
}

float signed_power(Rng* rng, int low, int high) {
  float x =
      std::ldexp(1 + next_float(rng), low + static_cast<int>(next_u32(rng) % static_cast<std::uint32_t>(high - low)));
  return next_u32(rng) % 2 ? -x : x;
}

}  // namespace

// Goal: no hit is lost where some of the sheared coordinates are denormal and others are not, so that an edge function
// of flushed numbers has the wrong sign. Method: triangles in a plane that a ray all but lies in, against brute force.
TEST_CASE("accel_denormals_change_no_edge") {
  Rng rng = make_rng(5);
  Tally tally;
  for (int n = 0; n < 20000; ++n) {
    Mesh mesh;
    auto corner = [&] { return Vec3{0, signed_power(&rng, 0, 12), signed_power(&rng, -66, -55)}; };
    Vec3 a = corner(), b = corner();
    add_triangle(&mesh, a, b, corner());
    auto oracle = make_world(mesh, &kBruteAccel);
    auto world = make_world(mesh, &kBvhAccel);
    Ray ray = {{signed_power(&rng, -130, -124), 0, 0}, {signed_power(&rng, -66, -60), 0, 1}, kInfinity};
    for (const Variant& variant : all_variants())
      if (variant.accel == &kBvhAccel) compare(variant, *world, *oracle, ray, &tally);
  }
  CHECK(tally.wrong == 0);
  CHECK(tally.hits > 0);
}

// Goal: hits next to denormals are the same on every instruction set, also on one that flushes denormals. Method:
// vertices, origins and directions down to 2^-60 (traced by all kernels) and to 2^-149 (left to the baseline), against
// brute force, which computes in IEEE floats and doubles alone.
TEST_CASE("accel_denormals_change_no_hit") {
  for (int exponent_min : {-60, -149}) {
    Rng rng = make_rng(static_cast<std::uint64_t>(-exponent_min));
    std::vector<Tally> tallies(all_variants().size());
    int wrong_shadows = 0;
    for (int n = 0; n < effort(300); ++n) {
      Mesh mesh = awkward_mesh(&rng, exponent_min);
      auto oracle = make_world(mesh, &kBruteAccel);
      Ray rays[kGroupMax];
      Vec3 origin = awkward3(&rng, exponent_min);
      float t_max = next_u32(&rng) % 4 ? kInfinity : std::fabs(awkward(&rng, exponent_min));
      for (Ray& ray : rays) {
        // Half of them along an axis, but for a shear that is tiny.
        Vec3 d = awkward3(&rng, exponent_min / 2);
        if (next_u32(&rng) % 2) d[static_cast<int>(next_u32(&rng) % 3)] = next_u32(&rng) % 2 ? 1.0f : -1.0f;
        ray = {origin, d, t_max};
      }
      Hit expected[kGroupMax];
      for (int i = 0; i < kGroupMax; ++i) expected[i] = closest(*oracle, rays[i]);
      std::size_t index = 0;
      for (const Variant& variant : all_variants()) {
        auto world = make_world(mesh, variant.accel);
        Hit hits[kGroupMax];
        answer(variant, *world, rays, kGroupMax, nullptr, hits);
        Tally& tally = tallies[index++];
        SegmentPacket segments;
        segments.count = kPacketMax;
        for (int i = 0; i < kGroupMax; ++i) {
          ++tally.rays, tally.hits += expected[i].triangle != kNoTriangle;
          tally.wrong += !same_hit(hits[i], expected[i]);
          // To a common end.
          Vec3 from = rays[i].origin + rays[i].direction;
          set_ray(&segments, static_cast<std::uint32_t>(i), {from, origin - from, t_max < 1 ? t_max : 1});
        }
        std::uint64_t blocked = variant.accel->occluded_packet(world->accel, segments, nullptr, nullptr);
        for (std::uint32_t i = 0; i < kPacketMax; ++i)
          wrong_shadows +=
              kBruteAccel.occluded(oracle->accel, ray_of(segments, i), nullptr, nullptr) != (blocked >> i & 1);
      }
    }
    std::size_t index = 0;
    for (const Variant& variant : all_variants()) {
      const Tally& tally = tallies[index++];
      INFO(name_of(variant) << ", " << tally.hits << " hits");
      CHECK(tally.wrong == 0);
      CHECK(tally.hits > tally.rays / 20);
    }
    CHECK(wrong_shadows == 0);
  }
  select_isa(best_isa());
}

TEST_CASE("accel_denormals_are_guarded_against") {
  Accel accel;
  accel.least_coordinate = kCoordinateMin;
  const Ray plain = {{1, 0, -kCoordinateMin}, {0, 0x1p-40f, -1}, kInfinity};
  auto is_safe = [&](Vec3 origin, Vec3 direction, float t_max) {
    Ray ray = {origin, direction, t_max};
    const bool safe = is_safe_to_flush(accel, ray);
    for (std::uint32_t place = 0; place < 7; ++place) {  // one of four at once, or one of the rest
      CAPTURE(place);
      RayPacket rays;
      SegmentPacket segments;
      rays.origin = origin, rays.t_max = t_max, rays.count = segments.count = 7;
      for (std::uint32_t i = 0; i < 7; ++i) {
        const Ray& own = i == place ? ray : plain;
        set_ray(&segments, i, own);
        for (int axis = 0; axis < 3; ++axis) rays.direction[axis][i] = own.direction[axis];
      }
      CHECK(is_safe_to_flush(accel, rays) == safe);
      CHECK(is_safe_to_flush(accel, segments) == safe);
#if defined(POCKETRAY_HAVE_NEON32)
      CHECK(is_safe_to_flush_by_fours(accel, rays) == safe);
      CHECK(is_safe_to_flush_by_fours(accel, segments) == safe);
#endif
    }
    return safe;
  };
  CHECK(is_safe(plain.origin, plain.direction, kInfinity));
  CHECK_FALSE(is_safe({1, 0, kCoordinateMin / 2}, plain.direction, kInfinity));
  CHECK_FALSE(is_safe(plain.origin, {0, 0x1p-42f, -1}, kInfinity));
  CHECK_FALSE(is_safe(plain.origin, {0, 0, 0}, kInfinity));
  CHECK_FALSE(is_safe(plain.origin, {0, 0, 0x1p31f}, kInfinity));
  CHECK_FALSE(is_safe(plain.origin, {0, 0, 0x1p-61f}, kInfinity));
  CHECK_FALSE(is_safe(plain.origin, {0, NAN, 1}, kInfinity));
  CHECK_FALSE(is_safe(plain.origin, plain.direction, kCoordinateMin / 2));
  CHECK(is_safe(plain.origin, plain.direction, 0));
  accel.least_coordinate = kCoordinateMin / 2;
  CHECK_FALSE(is_safe(plain.origin, plain.direction, kInfinity));
}
