// Thousands of coinciding triangles: they are built within the plan and answered as by brute force.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "accel/bvh.h"
#include "accel/degenerate.h"
#include "accel/variant.h"
#include "support/effort.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

// A ray at or past a vertex, from near or far.
Ray ray_at(Rng* rng, const Mesh& mesh, const Vec3& origin) {
  const Triangle& t = mesh.triangles[next_u32(rng) % mesh.triangles.size()];
  Vec3 a = mesh.positions[t.vertex(0)], b = mesh.positions[t.vertex(1)], c = mesh.positions[t.vertex(2)];
  float u = next_float(rng), v = (1 - u) * next_float(rng);
  Vec3 target = next_u32(rng) % 4 ? a + (b - a) * u + (c - a) * v : a;
  return {origin, target - origin, next_u32(rng) % 4 ? kInfinity : 1.0f};
}

struct Questions {
  RayPacket rays;
  SegmentPacket segments;
  std::uint64_t blocked;
  Hit hits[kPacketMax];
};

Questions ask_brute_force(Rng* rng, const Mesh& mesh, const World& oracle) {
  Questions q;
  std::uint32_t n = static_cast<std::uint32_t>(mesh.triangles.size());
  std::uint32_t most = next_u32(rng) % 4 ? 16 : kPacketMax;
  q.rays.count = q.segments.count = std::max(4u, std::min(most, 100000u / n));
  Vec3 size = extent(oracle.accel.bounds);
  q.rays.origin = center(oracle.accel.bounds) + random_vec3(rng, next_u32(rng) % 2 ? 2.0f : 0.5f) * size;
  q.rays.t_max = next_u32(rng) % 4 ? kInfinity : 1.0f;
  for (std::uint32_t i = 0; i < q.rays.count; ++i) {
    Ray ray = ray_at(rng, mesh, q.rays.origin);
    for (int axis = 0; axis < 3; ++axis) q.rays.direction[axis][i] = ray.direction[axis];
    q.hits[i] = closest(oracle, ray_of(q.rays, i));
    Vec3 from = q.rays.origin + random_vec3(rng, next_u32(rng) % 2 ? 0.01f : 1.0f) * size;
    set_ray(&q.segments, i, ray_at(rng, mesh, from));
  }
  q.blocked = kBruteAccel.occluded_packet(oracle.accel, q.segments, nullptr, nullptr);
  return q;
}

bool same_answer(const Hit& expected, const Hit& hit) {
  return expected.triangle == kNoTriangle ? hit.triangle == kNoTriangle : same_hit(expected, hit);
}

int wrong_answers(const World& world, const Questions& q) {
  int wrong = 0;
  Hit hits[kPacketMax];
  world.info->closest_packet(world.accel, q.rays, nullptr, hits, nullptr);
  wrong += world.info->occluded_packet(world.accel, q.segments, nullptr, nullptr) != q.blocked;
  for (std::uint32_t i = 0; i < q.rays.count; ++i) {
    wrong += !same_answer(q.hits[i], hits[i]) || !same_answer(q.hits[i], closest(world, ray_of(q.rays, i)));
    wrong += world.info->occluded(world.accel, ray_of(q.segments, i), nullptr, nullptr) != (q.blocked >> i & 1);
  }
  return wrong;
}

// Whether the build kept to its plan; of a BVH, also whether the tree is valid, has each triangle once, and has no more
// leaves and nodes than planned.
bool is_within_plan(const World& world) {
  if (!is_hierarchy(world.info))
    return world.keep.used_max <= world.info->need(static_cast<std::uint32_t>(world.triangles.size()));
  BvhView bvh(world.accel.data.data);
  std::size_t n = world.triangles.size(), leaves = bvh.header->leaf_count, found = 0;
  for (std::uint32_t i = 0; i < bvh.header->node_count; ++i)
    for (std::uint32_t child : bvh.nodes[i].child)
      if (child != kNoChild && (child & kLeafBit)) found += leaf_triangle_count(child);
  Accel copy = world.accel;
  return found == n && leaves <= (n + 3) / 4 + n / 128 && bvh.header->node_count <= 7 * leaves / 15 + 1 &&
         world.keep.used_max <= world.info->need(static_cast<std::uint32_t>(n)) &&
         world.info->adopt(&copy, world.accel.data, {}).ok;
}

// Opens degenerate triangles up by moving every vertex elsewhere.
void open_up(Rng* rng, Mesh* mesh) {
  for (Vec3& p : mesh->positions) p = p * 0.5f + random_vec3(rng, 1);
}

int first_seed() {
  const char* seed = std::getenv("POCKETRAY_SEED");
  return seed ? std::atoi(seed) : 1;
}

}  // namespace

// Goal: all triangles are built within the plan, the tree holds each of them, and its answers are the bits of brute
// force, even when they move afterwards. Method: seeded mixtures of points, lines, copies, planes and sound triangles
// from denormal to huge; every accelerator, the instruction sets in turn; single rays and packets, closest hits and
// shadows. The full gate has 10^4 meshes of up to 10^5 triangles; it takes hours, and POCKETRAY_SEED continues it.
TEST_CASE("differential_degenerate_meshes_are_built_within_plan_and_answered_as_by_brute_force") {
  int mesh_count = gate_share(1000, 10000);
  std::uint32_t count_max = whole_gate() ? 100000 : kSoftFloats ? 100 : effort_side(2000);
  for (int seed = first_seed(); seed <= mesh_count; ++seed) {
    Mesh mesh = degenerate_mesh(static_cast<std::uint64_t>(seed), count_max);
    INFO("seed " << seed << ": " << mesh.name);
    Rng rng = make_rng(static_cast<std::uint64_t>(seed), 1);
    auto oracle = make_world(mesh, &kBruteAccel);
    Questions questions = ask_brute_force(&rng, mesh, *oracle);
    Mesh moved = mesh;
    open_up(&rng, &moved);
    auto moved_oracle = make_world(moved, &kBruteAccel);
    Questions later = ask_brute_force(&rng, moved, *moved_oracle);
    select_isa(static_cast<Isa>(seed % (static_cast<int>(best_isa()) + 1)));
    int wrong = 0;
    for (const AccelInfo* info : kAccelList) {
      if (info == &kBruteAccel) continue;
      auto world = make_world(mesh, info);
      CHECK(is_within_plan(*world));
      wrong += wrong_answers(*world, questions);
      std::copy(moved.positions.begin(), moved.positions.end(), world->positions.begin());
      if (info->refit) {
        info->refit(&world->accel, {world->keep.base, world->accel.data.count});
      } else {
        rebuild(world.get());
      }
      wrong += wrong_answers(*world, later);
    }
    CHECK(wrong == 0);
    count_hard(questions.rays.count, static_cast<std::uint64_t>(wrong), "within plan, the bits of brute force");
    show_gate_progress(static_cast<std::uint64_t>(seed), static_cast<std::uint64_t>(mesh_count));
  }
  select_isa(best_isa());
}
