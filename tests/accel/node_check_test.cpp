// The quick checks of a BVH from a file.
#include "accel/node_check.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "accel/accel_world.h"
#include "accel/bvh.h"
#include "accel/fixed_area.h"

using namespace pocketray;

namespace {

// A copy of a tree that can be damaged, aligned.
struct Copy {
  explicit Copy(const World& world)
      : kind(world.info == &kBvhAccel ? kBlockLeaves : kCompactLeaves),
        block(new std::uint8_t[world.accel.data.count + 64]),
        data(block.get() + (64 - reinterpret_cast<std::uintptr_t>(block.get()) % 64) % 64),
        positions(world.accel.positions),
        triangles(world.accel.triangles) {
    std::memcpy(data, world.accel.data.data, world.accel.data.count);
  }
  BvhNode& node(std::uint32_t i) const { return BvhWritableView(data).nodes[i]; }
  std::uint8_t* leaf(std::uint32_t reference) const {
    return const_cast<std::uint8_t*>(leaf_at(kind, data, reference & kLeafIndexMask));
  }
  bool is_plain(std::uint32_t i) const {
    return is_plainly_sound({kind, BvhView(data).nodes, leaf_at(kind, data, 0), positions, triangles}, node(i));
  }
  const LeafKind& kind;
  std::unique_ptr<std::uint8_t[]> block;
  std::uint8_t* data;
  Array<const Vec3> positions;
  Array<const Triangle> triangles;
};

std::uint32_t node_count(const Copy& tree) { return BvhView(tree.data).header->node_count; }

const AccelInfo* const kBaked[] = {&kBvhAccel, &kCompactAccel};

}  // namespace

// Goal: the quick checks decide nearly always. Method: a soup without slivers, in which no node may need the slow ones.
TEST_CASE("node_check_passes_sound_nodes") {
  for (const AccelInfo* info : kBaked)
    for (int count : {1, 2, 3, 5, 300}) {
      const auto world = make_world(soup("", count, 1, 0.5f, 121), info);
      const Copy tree(*world);
      for (std::uint32_t i = 0; i < node_count(tree); ++i) CHECK(tree.is_plain(i));
    }
}

// Goal: no wrong word passes. Method: every word of a node's bounds and of its leaves, changed in several ways.
TEST_CASE("node_check_passes_no_wrong_word") {
  for (const AccelInfo* info : kBaked) {
    const auto world = make_world(soup("", 50, 1, 0.5f, 122), info);
    const Copy tree(*world);
    for (std::uint32_t i = 0; i < node_count(tree); ++i) {
      auto try_word = [&](std::uint8_t* at) {
        std::uint32_t kept, word;
        std::memcpy(&kept, at, sizeof kept);
        for (std::uint32_t flip : {1u, 1u << 22, 1u << 31, 0x7F800000u, 0xFFFFFFFFu, kept, kept ^ 0x7FC00000u}) {
          word = kept ^ flip;
          std::memcpy(at, &word, sizeof word);
          // A leaf may hold any triangles that fill its box, and a leaf of triangle blocks holds their vertices.
          const bool is_id = info == &kCompactAccel && word < tree.triangles.count && kept < tree.triangles.count;
          if (word != kept && !is_id && tree.is_plain(i))
            FAIL_CHECK(info->name, ": node ", i, " with ", word, " for ", kept);
        }
        std::memcpy(at, &kept, sizeof kept);
      };
      BvhNode& node = tree.node(i);
      for (auto& row : node.bounds)
        for (float& plane : row) try_word(reinterpret_cast<std::uint8_t*>(&plane));
      for (std::uint32_t child : node.child)
        if ((child & kLeafBit) && child != kNoChild)
          for (std::uint32_t byte = 0; byte < tree.kind.bytes; byte += 4) try_word(tree.leaf(child) + byte);
    }
  }
}

// Goal: a triangle that no ray may hit does not pass as one that can be hit. Method: collinear corners, at any scale
// and after rounding, in leaves as if they were not.
TEST_CASE("node_check_passes_no_degenerate_triangle") {
  Rng rng = make_rng(123);
  int plain = 0, degenerate = 0, fixed = 0;
  for (int i = 0; i < 4000; ++i) {
    const float scale = std::ldexp(1.0f, static_cast<int>(next_u32(&rng) % 170) - 120);
    const Vec3 a = random_vec3(&rng, 1) * scale, along = random_vec3(&rng, next_u32(&rng) % 2 ? 1 : 1e-3f) * scale;
    const Vec3 aside = random_vec3(&rng, next_u32(&rng) % 3 ? 1e-7f * next_float(&rng) : 1) * scale;
    const bool is_exact = next_u32(&rng) % 2 == 0;  // sums without rounding
    auto rounded = [&](const Vec3& p) { return Vec3{std::rint(p.x * 64), std::rint(p.y * 64), std::rint(p.z * 64)}; };
    Mesh mesh;
    if (is_exact)
      add_triangle(&mesh, rounded(a), rounded(a) + rounded(along), rounded(a) + rounded(along) * 3.0f);
    else
      add_triangle(&mesh, a, a + along, a + along * 3.0f + aside);
    const Triangle& t = mesh.triangles[0];
    const Vec3 p[3] = {mesh.positions[t.vertex(0)], mesh.positions[t.vertex(1)], mesh.positions[t.vertex(2)]};
    for (const AccelInfo* info : kBaked) {
      const auto world = make_world(mesh, info);
      const Copy tree(*world);
      std::uint8_t* leaf = tree.leaf(tree.node(0).child[0]);
      if (info == &kBvhAccel) {
        TriangleBlock* block = reinterpret_cast<TriangleBlock*>(leaf);
        for (int corner = 0; corner < 3; ++corner)
          for (int axis = 0; axis < 3; ++axis) block->vertex[corner][axis][0] = p[corner][axis];
      } else {
        for (std::uint32_t& id : reinterpret_cast<CompactLeaf*>(leaf)->triangle) id = 0;
      }
      const bool is_flat = is_degenerate(p[0], p[1], p[2]);
      if (is_flat && surely_has_area(p[0], p[1], p[2])) FAIL_CHECK("in fixed point: triangle ", i);
      fixed += surely_has_area(p[0], p[1], p[2]);
      if (is_flat) {
        ++degenerate;
        if (tree.is_plain(0)) FAIL_CHECK(info->name, ": triangle ", i);
      } else {
        plain += tree.is_plain(0);
      }
    }
  }
  CHECK(degenerate > 1000);
  CHECK(plain > 500);
  CHECK(fixed > 500);
}

// Goal: vertices out of range and coordinates that are too large or not finite are found.
TEST_CASE("node_check_finds_invalid_triangles") {
  const Mesh sound = soup("", 20, 1, 0.5f, 124);
  auto is_valid = [](const Mesh& m) {
    return has_only_valid_triangles({m.positions.data(), static_cast<std::uint32_t>(m.positions.size())},
                                    {m.triangles.data(), static_cast<std::uint32_t>(m.triangles.size())});
  };
  CHECK(is_valid(sound));
  CHECK(is_valid(Mesh()));
  for (std::size_t i = 0; i < sound.triangles.size(); ++i)
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      Mesh mesh = sound;
      mesh.triangles[i].set_vertex(corner, static_cast<std::uint32_t>(mesh.positions.size()));
      CHECK(!is_valid(mesh));
    }
  for (std::size_t i = 0; i < sound.positions.size(); ++i)
    for (float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF, 2 * kCoordinateMax, -2 * kCoordinateMax}) {
      Mesh mesh = sound;
      mesh.positions[i][static_cast<int>(i % 3)] = bad;
      CHECK(!is_valid(mesh));
      mesh.positions[i][static_cast<int>(i % 3)] = bad < 0 ? -kCoordinateMax : kCoordinateMax;
      CHECK(is_valid(mesh));
    }
}
