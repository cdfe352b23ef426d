// Refits that leave alone what cannot move.
#include <doctest/doctest.h>

#include "accel/accel_world.h"
#include "accel/bvh.h"
#include "accel/variant.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

Array<std::uint8_t> data_of(World* world) { return {world->keep.base, world->accel.data.count}; }

// A few runs of vertices in ascending order, also none and all.
std::vector<MovingMesh> next_runs(Rng* rng, std::uint32_t vertex_count) {
  std::vector<MovingMesh> runs;
  for (std::uint32_t v = 0; v < vertex_count;) {
    MovingMesh run = {};
    run.vertex_begin = v + next_u32(rng) % vertex_count;
    if (run.vertex_begin >= vertex_count) break;
    run.vertex_count = 1 + next_u32(rng) % (vertex_count - run.vertex_begin);
    if (next_u32(rng) % 2) run.vertex_count = 1 + run.vertex_count / 16;
    runs.push_back(run);
    v = run.vertex_begin + run.vertex_count;
  }
  return runs;
}

// Clears the marks, in which alone settled data differ from others.
void clear_marks(World* world, std::uint64_t* mark_count) {
  BvhWritableView bvh(data_of(world).data);
  for (std::uint32_t i = 0; i < bvh.header->node_count; ++i) {
    *mark_count += static_cast<std::uint64_t>(__builtin_popcount(bvh.nodes[i].still));
    bvh.nodes[i].still = 0;
  }
}

}  // namespace

// Goal: after a refit that leaves marked children alone, every byte but the marks is that of a whole refit. Method:
// random runs of vertices move, twice, in a mesh that shares vertices and in one that does not; both kinds of leaves.
TEST_CASE("refit_of_what_moves_equals_a_whole_refit") {
  Rng rng = make_rng(5);
  std::uint64_t mark_count = 0;
  for (int round = 0; round < effort(200); ++round) {
    const Mesh mesh = round % 2 ? jittered_sphere(2, 1, {0, 0, 0}, 0.1f, static_cast<std::uint64_t>(round))
                                : soup("soup", 150, 1, 0.2f, static_cast<std::uint64_t>(round));
    const auto runs = next_runs(&rng, static_cast<std::uint32_t>(mesh.positions.size()));
    for (const AccelInfo* info : {&kBvhAccel, &kCompactAccel}) {
      CAPTURE(round);
      auto settled = make_world(mesh, info), whole = make_world(mesh, info);
      info->settle(&settled->accel, data_of(settled.get()), {runs.data(), static_cast<std::uint32_t>(runs.size())});
      for (int step = 0; step < 2; ++step) {
        for (const MovingMesh& run : runs)
          for (std::uint32_t v = run.vertex_begin; v < run.vertex_begin + run.vertex_count; ++v)
            settled->positions[v] = whole->positions[v] = random_vec3(&rng, 2);
        info->refit(&settled->accel, data_of(settled.get()));
        info->refit(&whole->accel, data_of(whole.get()));
      }
      clear_marks(settled.get(), &mark_count);
      REQUIRE(settled->accel.data.count == whole->accel.data.count);
      REQUIRE(std::memcmp(settled->accel.data.data, whole->accel.data.data, whole->accel.data.count) == 0);
      REQUIRE(std::memcmp(&settled->accel.bounds, &whole->accel.bounds, sizeof(Box)) == 0);
      REQUIRE(settled->accel.least_coordinate == whole->accel.least_coordinate);
    }
  }
  CHECK(mark_count > 0);
}

// Goal: where nothing moves, a refit touches nothing. Method: a box that no triangle has stays as it is.
TEST_CASE("refit_leaves_still_children_alone") {
  auto world = make_world(soup("soup", 150, 1, 0.2f, 1), &kBvhAccel);
  MovingMesh run = {};
  run.vertex_begin = 0, run.vertex_count = 3;  // the first triangle
  kBvhAccel.settle(&world->accel, data_of(world.get()), {&run, 1});
  BvhWritableView bvh(data_of(world.get()).data);
  std::uint32_t followed = 0, overwritten = 0;
  const Box none = {{5, 5, 5}, {6, 6, 6}};
  for (int pass = 0; pass < 2; ++pass) {
    for (std::uint32_t i = 0; i < bvh.header->node_count; ++i) {
      for (int lane = 0; lane < 4 && bvh.nodes[i].child[lane] != kNoChild; ++lane) {
        const bool still = (bvh.nodes[i].still >> lane & 1) != 0;
        followed += pass == 0 && !still;
        if (pass == 0 && still) set_child_box(&bvh.nodes[i], lane, none);
        if (pass == 1 && still) overwritten += child_box(bvh.nodes[i], lane).low.x != 5;
      }
    }
    if (pass == 0) kBvhAccel.refit(&world->accel, data_of(world.get()));
  }
  CHECK(followed > 0);
  CHECK(followed <= kBvhDepthMax);  // the way to the one leaf
  CHECK(overwritten == 0);
}
