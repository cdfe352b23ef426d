// Packets of shadow rays whose origins and light lie close to the planes of triangles, on one side or on both.
#include <doctest/doctest.h>

#include <cmath>

#include "accel/accel_world.h"
#include "accel/variant.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// A few triangles of sizes from 1 to 2^-12, some of them slivers, some sharing an edge.
Mesh few_triangles(Rng* rng) {
  Mesh mesh = {"few triangles", {}, {}};
  const std::uint32_t count = 1 + next_u32(rng) % 6;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float size = std::ldexp(1.0f, -static_cast<int>(next_u32(rng) % 13));
    const Vec3 corner = random_vec3(rng, 1);
    Vec3 a = random_vec3(rng, size), b = random_vec3(rng, size);
    if (next_u32(rng) % 4 == 0) b = a * 0.75f + random_vec3(rng, size * 0x1p-10f);
    if (next_u32(rng) % 4 == 0) a.x = b.x = 0;  // in a plane of the axes
    const std::uint32_t first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {corner, corner + a, corner + b, corner + a + b});
    mesh.triangles.push_back(Triangle(first, first + 1, first + 2, 0));
    if (next_u32(rng) % 2) mesh.triangles.push_back(Triangle(first + 1, first + 3, first + 2, 0));
  }
  return mesh;
}

struct Heights {
  float origins, light;
};
// Heights over a plane, two of three pairs on one side of it, from none to the scene's size.
Heights random_heights(Rng* rng) {
  auto height = [&] {
    return next_u32(rng) % 8 ? std::ldexp(1 + next_float(rng), -static_cast<int>(next_u32(rng) % 28)) : 0.0f;
  };
  const float side = next_u32(rng) % 2 ? 1.0f : -1.0f;
  return {side * height(), (next_u32(rng) % 3 ? side : -side) * height()};
}

// Rays from points about a triangle, at heights over its plane, to a light or along a direction.
SegmentPacket segments_beside(Rng* rng, const Mesh& mesh) {
  const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
  const Vec3 corner = mesh.positions[t.vertex(0)], a = mesh.positions[t.vertex(1)] - corner,
             b = mesh.positions[t.vertex(2)] - corner;
  Vec3 normal = cross(a, b);
  const float size = length(normal);
  normal = size > 0 ? normal / size : Vec3{0, 0, 1};
  const Heights heights = random_heights(rng);
  const bool is_parallel = next_u32(rng) % 4 == 0, is_level = next_u32(rng) % 2;
  const float reach = next_u32(rng) % 2 ? 1.0f : 8.0f;
  auto in_plane = [&] {
    // On an edge or its extension, at a corner, or anywhere.
    const float u = reach * (2 * next_float(rng) - 0.5f), v = reach * (2 * next_float(rng) - 0.5f);
    const std::uint32_t kind = next_u32(rng) % 8;
    return kind == 0   ? corner
           : kind == 1 ? corner + a * u
           : kind == 2 ? corner + a * u + b * (1 - u)
                       : corner + a * u + b * v;
  };
  const Vec3 light = in_plane() + normal * heights.light, along = light - in_plane();
  SegmentPacket packet;
  packet.count = kPacketMax;
  for (std::uint32_t i = 0; i < packet.count; ++i) {
    const Vec3 origin = in_plane() + normal * (is_level ? heights.origins : heights.origins * (1 + next_float(rng)));
    set_ray(&packet, i, {origin, is_parallel ? along : light - origin, is_parallel ? kInfinity : 1.0f});
  }
  return packet;
}

}  // namespace

// Goal: dropping triangles from whose planes a packet stays away loses no hit and adds none. Method: 10⁵ rays to lights
// and along directions close to planes, edges and corners, against occluded() of brute force.
TEST_CASE("accel_packets_beside_planes_are_blocked_as_their_rays_are") {
  Rng rng = make_rng(139);
  int blocked_count = 0;
  for (int n = 0; n < effort(1600); ++n) {
    const Mesh mesh = few_triangles(&rng);
    auto oracle = make_world(mesh, &kBruteAccel);
    const SegmentPacket packet = segments_beside(&rng, mesh);
    std::uint64_t expected = 0;
    for (std::uint32_t i = 0; i < packet.count; ++i)
      expected |= std::uint64_t(kBruteAccel.occluded(oracle->accel, ray_of(packet, i), nullptr, nullptr)) << i;
    blocked_count += __builtin_popcountll(expected);
    for (const Variant& variant : all_variants()) {
      if (!variant.in_packets) continue;
      INFO(name_of(variant) << ", packet " << n);
      auto world = make_world(mesh, variant.accel);
      select_isa(variant.isa);
      REQUIRE(variant.accel->occluded_packet(world->accel, packet, nullptr, nullptr) == expected);
    }
  }
  CHECK(blocked_count > 0);
  select_isa(best_isa());
}
