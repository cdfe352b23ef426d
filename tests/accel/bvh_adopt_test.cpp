#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>

#include "accel/accel_world.h"
#include "accel/bvh.h"

using namespace pocketray;

namespace {

// A copy of an accelerator's bytes, aligned and of exactly their size, so that a sanitizer sees an overrun.
struct Bytes {
  explicit Bytes(std::uint32_t count) : block(new std::uint8_t[count + 64]), data{align(block.get()), count} {}
  static std::uint8_t* align(std::uint8_t* p) { return p + (64 - reinterpret_cast<std::uintptr_t>(p) % 64) % 64; }
  std::unique_ptr<std::uint8_t[]> block;
  Array<std::uint8_t> data;
};

Bytes copy_of(const World& world, std::uint32_t count) {
  Bytes bytes(count);
  std::memcpy(bytes.data.data, world.accel.data.data, count);
  return bytes;
}

// Whether the bytes are adopted; `world` then uses them as long as they live.
bool adopt(World* world, const Bytes& bytes) { return world->info->adopt(&world->accel, bytes.data, {}).ok; }
bool refuses(const World& world, const Bytes& bytes) {
  Accel accel = world.accel;
  return !world.info->adopt(&accel, bytes.data, {}).ok;
}

const AccelInfo* const kBaked[] = {&kBvhAccel, &kCompactAccel};

// Traces rays through whatever was adopted: must terminate and stay in bounds.
void trace_some(const World& world, int ray_count) {
  Rng rng = make_rng(111);
  TraceStats stats;
  for (int i = 0; i < ray_count; ++i) closest(world, {random_vec3(&rng, 1), random_vec3(&rng, 1), kInfinity}, &stats);
  CHECK(stats.nodes <= static_cast<std::uint64_t>(ray_count) * BvhView(world.accel.data.data).header->node_count);
}

}  // namespace

// Goal: a built tree is adopted and answers the same, including bounds. Method: all generated meshes.
TEST_CASE("bvh_adopts_what_it_built") {
  for (const AccelInfo* info : kBaked)
    for (const Mesh& mesh : generated_meshes()) {
      auto world = make_world(mesh, info), fresh = make_world(mesh, info);
      Bytes bytes = copy_of(*world, world->accel.data.count);
      fresh->accel.bounds = empty_box(), fresh->accel.data = {};
      INFO(mesh.name << ", " << info->name);
      CHECK(accel_of(bytes.data) == info);
      REQUIRE(adopt(fresh.get(), bytes));
      CHECK(fresh->accel.bounds.low == world->accel.bounds.low);
      CHECK(fresh->accel.bounds.high == world->accel.bounds.high);
      trace_some(*fresh, 20);
    }
}

// Goal: no damaged byte does harm. Method: each byte of a small tree flipped in several ways; either adopt() refuses,
// or rays traced through it terminate. (Signs of zeros may flip; nothing else is accepted.)
TEST_CASE("bvh_refuses_every_flipped_byte_or_traces_it_safely") {
  Mesh mesh = soup("", 60, 1, 0.5f, 112);
  for (const AccelInfo* info : kBaked) {
    auto world = make_world(mesh, info);
    int accepted = 0;
    for (std::uint32_t i = 0; i < world->accel.data.count; ++i)
      for (std::uint8_t flip : {0x01, 0x80, 0xFF, 0x10}) {
        Bytes bytes = copy_of(*world, world->accel.data.count);
        bytes.data[i] ^= flip;
        World damaged;
        damaged.positions = world->positions, damaged.triangles = world->triangles, damaged.info = info;
        damaged.accel = world->accel;
        if (!adopt(&damaged, bytes)) continue;
        ++accepted;
        trace_some(damaged, 100);
      }
    INFO(info->name);
    CHECK(accepted <= 8);
  }
}

// Goal: the fault that is reported does not depend on threads. Method: a tree of several parts with two damaged nodes,
// checked forwards and backwards.
TEST_CASE("bvh_reports_the_first_damaged_node") {
  const ParallelLoop backwards = {
      [](void*, std::uint32_t item_count, void (*take)(void* context, std::uint32_t item), void* context) {
        while (item_count-- > 0) take(context, item_count);
      },
      nullptr};
  auto world = make_world(soup("", 40000, 1, 0.01f, 117), &kBvhAccel);
  Bytes bytes = copy_of(*world, world->accel.data.count);
  BvhWritableView bvh(bytes.data.data);
  REQUIRE(bvh.header->node_count > 3000);
  CHECK(world->info->adopt(&world->accel, bytes.data, backwards).ok);
  for (std::uint32_t i : {2500u, 1200u, 1201u}) bvh.nodes[i].bounds[4][0] = 1e6f;
  for (const ParallelLoop& loop : {ParallelLoop(), backwards}) {
    Accel accel = world->accel;
    const Status status = world->info->adopt(&accel, bytes.data, loop);
    CHECK(!status.ok);
    CHECK(std::strstr(status.message, "node ") != nullptr);
    const unsigned long node = std::strtoul(std::strstr(status.message, "node ") + 5, nullptr, 10);
    CHECK(node <= 1200);  // or its parent, whose box does not fit it any more
    CHECK(node ==
          std::strtoul(std::strstr(world->info->adopt(&accel, bytes.data, {}).message, "node ") + 5, nullptr, 10));
  }
}

// Goal: prefixes and excess bytes are refused. Method: every length.
TEST_CASE("bvh_refuses_every_prefix_and_excess_bytes") {
  for (const AccelInfo* info : kBaked) {
    auto world = make_world(soup("", 30, 1, 0.5f, 113), info);
    for (std::uint32_t count = 0; count < world->accel.data.count; ++count)
      CHECK(refuses(*world, copy_of(*world, count)));
    Bytes longer(world->accel.data.count + 64);
    std::memcpy(longer.data.data, world->accel.data.data, world->accel.data.count);
    CHECK(refuses(*world, longer));
  }
}

// Goal: crafted trees that would never end or overrun the stack are refused. Method: a child that is its own parent, a
// child shared by two lanes, a chain deeper than kBvhDepthMax with otherwise correct boxes, a leaf of another scene.
TEST_CASE("bvh_refuses_cycles_shared_children_deep_chains_and_other_geometry") {
  auto world = make_world(soup("", 200, 1, 0.5f, 114), &kBvhAccel);
  auto with_child = [&](int lane, std::uint32_t child) {
    Bytes bytes = copy_of(*world, world->accel.data.count);
    BvhWritableView(bytes.data.data).nodes[0].child[lane] = child;
    return !refuses(*world, bytes);
  };
  const BvhNode& root = BvhView(world->accel.data.data).nodes[0];
  REQUIRE(!(root.child[0] & kLeafBit));
  CHECK(with_child(0, root.child[0]));  // without a change it is adopted
  CHECK_FALSE(with_child(0, 0));
  CHECK_FALSE(with_child(1, root.child[0]));
  CHECK_FALSE(with_child(0, kNoChild));
  CHECK_FALSE(with_child(3, leaf_reference(0, 4)));

  // One triangle at the end of a chain of single-child nodes.
  auto single = make_world(soup("", 1, 0.1f, 1, 115), &kBvhAccel);
  for (std::uint32_t depth : {kBvhDepthMax, kBvhDepthMax + 1}) {
    Bytes bytes(static_cast<std::uint32_t>(bvh_bytes(depth, 1)));
    *reinterpret_cast<BvhHeader*>(bytes.data.data) = {kBvhMagic, 1, depth, 1, {0}};
    BvhWritableView chain(bytes.data.data);
    for (std::uint32_t i = 0; i < depth; ++i) {
      chain.nodes[i] = BvhView(single->accel.data.data).nodes[0];
      if (i + 1 < depth) chain.nodes[i].child[0] = i + 1;
    }
    chain.leaves[0] = BvhView(single->accel.data.data).leaves[0];
    CHECK(refuses(*single, bytes) == (depth > kBvhDepthMax));
  }

  auto other = make_world(soup("", 200, 1, 0.5f, 116), &kBvhAccel);
  CHECK(refuses(*other, copy_of(*world, world->accel.data.count)));
}

// Goal: a leaf of ids with wrong marks of what can be hit, or with a triangle that the scene lacks, is refused, as are
// the bytes of the other kind. Method: one good and one degenerate triangle; each id changed.
TEST_CASE("compact_refuses_false_marks_foreign_ids_and_the_other_kind") {
  Mesh mesh;
  add_triangle(&mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(&mesh, {0, 0, 0}, {1, 1, 0}, {2, 2, 0});
  auto world = make_world(mesh, &kCompactAccel), other = make_world(mesh, &kBvhAccel);
  std::uint32_t leaf_offset = world->accel.data.count - static_cast<std::uint32_t>(sizeof(CompactLeaf));
  const std::uint32_t good[] = {0, 1 | kUnhittableBit, 0, 0};
  REQUIRE(std::memcmp(world->accel.data.data + leaf_offset, good, sizeof good) == 0);
  for (std::uint32_t lane = 0; lane < 4; ++lane)
    for (std::uint32_t id : {0u, 1u, 2u, 0x7FFFFFFFu, kUnhittableBit, 1 | kUnhittableBit, kNoTriangle}) {
      Bytes bytes = copy_of(*world, world->accel.data.count);
      std::memcpy(bytes.data.data + leaf_offset + 4 * lane, &id, sizeof id);
      CHECK(refuses(*world, bytes) == (id != good[lane]));
    }
  CHECK(refuses(*world, copy_of(*other, other->accel.data.count)));
  CHECK(refuses(*other, copy_of(*world, world->accel.data.count)));
}
