#include <doctest/doctest.h>

#include <cmath>

#include "accel/accel_world.h"
#include "accel/variant.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// Rays from one point: towards a part of the mesh that is `spread` of its size wide, some at vertices, or in all
// directions.
RayPacket packet_about(Rng* rng, const Mesh& mesh, const Box& bounds, float spread) {
  Vec3 middle = is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds);
  float size = is_empty(bounds) ? 1.0f : max_component(extent(bounds));
  RayPacket packet;
  packet.origin = middle + random_vec3(rng, size * (next_u32(rng) % 2 ? 2.0f : 0.6f));
  packet.t_max = next_u32(rng) % 4 ? kInfinity : 0.9f;
  packet.count = next_u32(rng) % 2 ? kPacketMax : 1 + next_u32(rng) % kPacketMax;
  Vec3 target = middle + random_vec3(rng, size * 0.4f);
  for (std::uint32_t i = 0; i < packet.count; ++i) {
    Vec3 aim = target + random_vec3(rng, size * spread);
    if (!mesh.triangles.empty() && next_u32(rng) % 4 == 0)
      aim = mesh.positions[mesh.triangles[next_u32(rng) % mesh.triangles.size()].vertex(next_u32(rng) % 3)];
    Vec3 direction = next_u32(rng) % 64 ? aim - packet.origin : Vec3{0, 0, 0};
    for (int axis = 0; axis < 3; ++axis) packet.direction[axis][i] = direction[axis];
  }
  return packet;
}

bool accept_some(const void*, std::uint32_t triangle, float u, float v) { return triangle % 3 != 0 && u <= 0.7f - v; }
// Asked with ids of the mesh alone.
struct MeshIds {
  std::uint32_t count;
  mutable bool is_exceeded = false;
};
bool accept_some_triangles(const void* context, std::uint32_t triangle, float, float) {
  const MeshIds& ids = *static_cast<const MeshIds*>(context);
  ids.is_exceeded = ids.is_exceeded || triangle >= ids.count;
  return triangle % 3 != 0;
}

}  // namespace

// Goal: a packet answers like its rays. Method: packets with one dominant axis, several and all, full and partial, with
// and without a filter, against closest() of brute force, bit for bit.
TEST_CASE("accel_packets_hit_what_their_rays_hit") {
  HitFilter some = {accept_some, nullptr};
  for (const Mesh& mesh : generated_meshes()) {
    auto oracle = make_world(mesh, &kBruteAccel);
    for (const AccelInfo* info : kAccelList) {
      auto world = make_world(mesh, info);
      Rng rng = make_rng(131);
      int wrong = 0, hit_count = 0;
      for (int n = 0; n < effort(120); ++n) {
        float spread[] = {0.02f, 0.2f, 2.0f};
        RayPacket packet = packet_about(&rng, mesh, oracle->accel.bounds, spread[n % 3]);
        const HitFilter* filter = n % 4 == 0 ? &some : nullptr;
        Hit hits[kPacketMax];
        world->info->closest_packet(world->accel, packet, filter, hits, nullptr);
        for (std::uint32_t i = 0; i < packet.count; ++i) {
          Vec3 direction = {packet.direction[0][i], packet.direction[1][i], packet.direction[2][i]};
          Hit expected = closest(*oracle, {packet.origin, direction, packet.t_max}, nullptr, filter);
          bool hit = expected.triangle != kNoTriangle;
          wrong += hit ? !same_hit(expected, hits[i]) : hits[i].triangle != kNoTriangle;
          hit_count += hit;
        }
      }
      INFO(mesh.name << ", " << info->name << ", " << hit_count << " hits");
      CHECK(wrong == 0);
    }
  }
}

namespace {

// Rays from places around a part of the mesh, some aimed past a vertex, to one light or along one direction. Their ends
// sometimes miss the light by a fraction of the scene's size, and a packet in six passes it: those are not bundles.
SegmentPacket segments_about(Rng* rng, const Mesh& mesh, const Box& bounds, float spread) {
  Vec3 middle = is_empty(bounds) ? Vec3{0, 0, 0} : center(bounds);
  float size = is_empty(bounds) ? 1.0f : max_component(extent(bounds));
  SegmentPacket packet;
  packet.count = next_u32(rng) % 2 ? kPacketMax : 1 + next_u32(rng) % kPacketMax;
  Vec3 start = middle + random_vec3(rng, size * 0.5f), light = middle + random_vec3(rng, size * 1.2f);
  bool parallel = next_u32(rng) % 4 == 0;
  float misses[] = {0, 0, 0x1p-20f, 0x1p-14f}, miss = misses[next_u32(rng) % 4] * size;
  float ends[] = {1, 1, 1, 1, 0.3f, kInfinity}, end = parallel ? kInfinity : ends[next_u32(rng) % 6];
  for (std::uint32_t i = 0; i < packet.count; ++i) {
    Vec3 origin = start + random_vec3(rng, size * spread);
    if (!mesh.triangles.empty() && next_u32(rng) % 4 == 0) {
      Vec3 corner = mesh.positions[mesh.triangles[next_u32(rng) % mesh.triangles.size()].vertex(next_u32(rng) % 3)];
      Vec3 back = parallel ? start - light : corner - light;
      origin = corner + back * (next_u32(rng) % 2 ? next_float(rng) : 0.0f);
    }
    Vec3 direction = parallel ? light - start : light - origin + random_vec3(rng, miss);
    if (next_u32(rng) % 256 == 0) direction = {0, 0, 0};
    const std::uint32_t triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
    const bool names_one = triangle_count > 0 && next_u32(rng) % 4 == 0;
    const std::uint32_t from = names_one ? next_u32(rng) % triangle_count : kNoTriangle;
    set_ray(&packet, i, {origin, direction, next_u32(rng) % 16 ? end : 0, from});
  }
  return packet;
}

}  // namespace

// Goal: a packet of shadow rays is blocked where its rays are. Method: packets to a light and along a direction, near
// and wide, with ends before, at and beyond the light, against occluded() of brute force.
TEST_CASE("accel_packets_of_shadow_rays_are_blocked_as_their_rays_are") {
  HitFilter some = {accept_some, nullptr};
  std::vector<Mesh> meshes = generated_meshes();
  // Among triangles that rays can hit, one that none can.
  meshes.push_back(soup("one unhittable", 64, 0.2f, 1, 5));
  for (std::uint32_t i = 0; i < 3; ++i) meshes.back().positions[meshes.back().triangles[1].vertex(i)].x = NAN;
  for (const Mesh& mesh : meshes) {
    MeshIds ids = {static_cast<std::uint32_t>(mesh.triangles.size())};
    const HitFilter some_triangles = {accept_some_triangles, &ids, false};
    auto oracle = make_world(mesh, &kBruteAccel);
    for (const Variant& variant : all_variants()) {
      if (!variant.in_packets) continue;
      auto world = make_world(mesh, variant.accel);
      select_isa(variant.isa);
      Rng rng = make_rng(137);
      int wrong = 0, blocked_count = 0;
      for (int n = 0; n < effort(120); ++n) {
        float spread[] = {0.02f, 0.2f, 2.0f};
        SegmentPacket packet = segments_about(&rng, mesh, oracle->accel.bounds, spread[n % 3]);
        const HitFilter* filter = n % 4 == 0 ? &some : n % 4 == 1 ? &some_triangles : nullptr;
        std::uint64_t blocked = variant.accel->occluded_packet(world->accel, packet, filter, nullptr);
        for (std::uint32_t i = 0; i < packet.count; ++i) {
          bool expected = kBruteAccel.occluded(oracle->accel, ray_of(packet, i), filter, nullptr);
          wrong += expected != (blocked >> i & 1), blocked_count += expected;
        }
        if (packet.count < kPacketMax) wrong += blocked >> packet.count != 0;
      }
      INFO(mesh.name << ", " << name_of(variant) << ", " << blocked_count << " blocked");
      CHECK(wrong == 0);
      CHECK_FALSE(ids.is_exceeded);
    }
  }
  select_isa(best_isa());
}

// Goal: rays that miss their common point lose no hits. Method: packets of two, a long ray and one whose end or origin
// is off the long one's by as much as a bundle allows, around a small triangle; and ends farther out than any scene.
TEST_CASE("accel_packets_of_shadow_rays_allow_for_what_misses_the_light") {
  constexpr float s = 0x1p-12f;
  struct Case {
    Vec3 origin, direction, corner[3];
  };
  const Case cases[] = {
      {{0.99f, 0, -1}, {0.9f * s - 0.99f, 0, 0.9f * s + 1}, {{0, -s, 0}, {0.1f * s, -s, 0}, {0.05f * s, s, 0}}},
      {{2.5f * s, 0, -0.5f * s},
       {-1.5f * s, 0, 1.5f * s},
       {{2.35f * s, -s, -0.4f * s}, {2.45f * s, -s, -0.4f * s}, {2.4f * s, s, -0.4f * s}}},
  };
  for (int n = 0; n < 3; ++n) {
    CAPTURE(n);
    const Case& c = cases[n % 2];
    Mesh mesh = {"one triangle", {c.corner[0], c.corner[1], c.corner[2]}, {Triangle(0, 1, 2, 0)}};
    if (n == 0) {  // across the ray where it is at z = -0.1
      float t = 0.9f / c.direction.z;
      for (Vec3& p : mesh.positions) p = p + c.origin + c.direction * t - Vec3{0.05f * s, 0, 0};
    }
    SegmentPacket packet;
    packet.count = 2;
    set_ray(&packet, 0, {{0, 0, -1}, {0, 0, 1}, 1});
    set_ray(&packet, 1, {c.origin, c.direction, 1});
    if (n == 2) {
      packet.count = 4;
      for (std::uint32_t i = 0; i < 4; ++i)
        set_ray(&packet, i, {{0.1f * static_cast<float>(i), 0, 0}, {0, 0, 1e30f}, 1});
    }
    auto oracle = make_world(mesh, &kBruteAccel);
    for (const Variant& variant : all_variants()) {
      if (!variant.in_packets) continue;
      INFO(name_of(variant));
      auto world = make_world(mesh, variant.accel);
      select_isa(variant.isa);
      CHECK(variant.accel->occluded_packet(world->accel, packet, nullptr, nullptr) ==
            kBruteAccel.occluded_packet(oracle->accel, packet, nullptr, nullptr));
    }
  }
  select_isa(best_isa());
}
