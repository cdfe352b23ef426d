// Guarantees of the builder of the BVH about the tree.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "accel/accel_world.h"
#include "accel/bvh.h"
#include "accel/bvh_treelet.h"

using namespace pocketray;

namespace {

struct TreeCount {
  std::size_t nodes, leaves, children, triangles;
};

TreeCount count_tree(const World& world) {
  BvhView bvh(world.accel.data.data);
  TreeCount count = {bvh.header->node_count, bvh.header->leaf_count, 0, 0};
  for (std::uint32_t i = 0; i < bvh.header->node_count; ++i)
    for (std::uint32_t child : bvh.nodes[i].child) {
      count.children += child != kNoChild;
      if (child != kNoChild && (child & kLeafBit)) count.triangles += leaf_triangle_count(child);
    }
  return count;
}

// FNV-1a over the words of the tree.
std::uint64_t hash_of(const World& world) {
  std::uint64_t hash = 14695981039346656037u;
  for (std::uint8_t byte : world.accel.data) hash = (hash ^ byte) * 1099511628211u;
  return hash;
}

// A cloud of triangles, drawn in an order that no compiler changes.
Mesh ordered_cloud(int count) {
  Mesh mesh;
  Rng rng = make_rng(126);
  for (int i = 0; i < count; ++i) {
    Vec3 p[3];
    for (Vec3& vertex : p)
      for (int axis = 0; axis < 3; ++axis) vertex[axis] = between(&rng, -0.1f, 0.1f);
    for (int axis = 0; axis < 3; ++axis) p[0][axis] += between(&rng, -1, 1);
    add_triangle(&mesh, p[0], p[0] + p[1], p[0] + p[2]);
  }
  return mesh;
}

}  // namespace

// Goal: for any number of triangles, all are in the tree, and it has no more leaves and nodes than planned: one leaf
// per 128 triangles above a quarter of the triangles, and 7/15 of that in nodes. Method: every count up to past two
// treelets, then some larger ones, of triangles in a cloud and of triangles that all coincide.
TEST_CASE("bvh_has_no_more_leaves_and_nodes_than_planned_for_any_triangle_count") {
  for (std::uint32_t n = 1; n < 6000; n += n < 300 ? 1 : 571)
    for (const Mesh& mesh :
         {soup("cloud", static_cast<int>(n), 1, 0.1f, n), duplicates("equal", static_cast<int>(n))}) {
      auto world = make_world(mesh, &kBvhAccel);
      TreeCount count = count_tree(*world);
      INFO(mesh.name << ", " << n << " triangles");
      CHECK(count.triangles == n);
      CHECK(count.leaves <= (n + 3) / 4 + n / 128);
      CHECK(count.nodes <= 7 * count.leaves / 15 + 1);
    }
}

// Goal: leaves and nodes of meshes are nearly full, which keeps the bytes per triangle low. Method: a soup and a sphere
// of some thousand triangles; the bounds are what the builder achieves, less some slack.
TEST_CASE("bvh_leaves_and_nodes_are_nearly_full") {
  for (const Mesh& mesh : {soup("soup", 5000, 1, 0.05f, 121), jittered_sphere(5, 1, {0, 0, 0}, 0.02f, 122)}) {
    auto world = make_world(mesh, &kBvhAccel);
    TreeCount count = count_tree(*world);
    double triangles = static_cast<double>(mesh.triangles.size());
    INFO(mesh.name << ": " << triangles / static_cast<double>(count.leaves) << " a leaf, "
                   << static_cast<double>(count.children) / static_cast<double>(count.nodes) << " a node");
    CHECK(triangles >= 3.85 * static_cast<double>(count.leaves));
    CHECK(count.children >= 3.7 * static_cast<double>(count.nodes));
    CHECK(world->accel.data.count <= 53 * triangles);
  }
}

// Goal: a treelet of L leaves collapses into treelet_node_count(L) nodes. Method: every count of triangles, in clouds.
TEST_CASE("bvh_treelet_collapses_into_the_fewest_nodes") {
  for (std::uint32_t n = 1; n <= kTreeletMax; ++n) {
    auto world = make_world(soup("cloud", static_cast<int>(n), 1, 0.1f, 1000 + n), &kBvhAccel);
    TreeCount count = count_tree(*world);
    INFO(n << " triangles");
    CHECK(count.leaves == leaves_for(n));
    CHECK(count.nodes == treelet_node_count(count.leaves));
  }
}

// Goal: the tree separates distant parts. Method: clusters far from one another; rays through one of them visit hardly
// more nodes and triangles than in a tree over that cluster alone.
TEST_CASE("bvh_separates_clusters_that_lie_apart") {
  Mesh alone = soup("alone", 800, 1, 0.1f, 123), all = alone;
  for (int k = 1; k < 7; ++k) {
    Mesh other = soup("", 100 * k, 1, 0.1f, 124 + static_cast<std::uint64_t>(k));
    for (const Triangle& t : other.triangles) {
      Vec3 shift = {k % 2 ? 50.0f : 0.0f, k % 3 ? 70.0f * static_cast<float>(k) : 0.0f, 90};
      add_triangle(&all, other.positions[t.vertex(0)] + shift, other.positions[t.vertex(1)] + shift,
                   other.positions[t.vertex(2)] + shift);
    }
  }
  TraceStats few, many;
  auto small = make_world(alone, &kBvhAccel), large = make_world(all, &kBvhAccel);
  Rng rng = make_rng(125);
  for (int i = 0; i < 2000; ++i) {
    Ray ray = {random_vec3(&rng, 1), {next_float(&rng) - 0.5f, 1, -0.2f}, kInfinity};
    closest(*small, ray, &few), closest(*large, ray, &many);
  }
  CHECK(many.nodes < few.nodes + 2 * 2000 + few.nodes / 10);
  CHECK(many.triangles < few.triangles + few.triangles / 10);
}

// Goal: no tree is too deep for the traversal stack. Method: triangles that shrink by powers of two, first along x,
// then along y. A node can only separate the five largest from the rest, which would take more levels than allowed:
// beyond some depth ranges must be halved instead.
TEST_CASE("bvh_halves_ranges_before_the_tree_is_too_deep") {
  Mesh mesh;
  for (int axis = 0; axis < 2; ++axis)
    for (int power = 59; power > -120; --power)
      for (int copy = 0; copy < (axis == 1 && power == -119 ? 5000 : 8); ++copy) {
        float size = std::ldexp(1.0f, power);
        Vec3 high = axis == 0 ? Vec3{size, 0x1p59f, 0} : Vec3{0x1p-120f, size, 0};
        add_triangle(&mesh, {0, 0, 0}, {high.x, 0, 0}, high);
      }
  auto world = make_world(mesh, &kBvhAccel);
  BvhView bvh(world->accel.data.data);
  std::vector<std::uint32_t> depth(bvh.header->node_count, 1);
  for (std::uint32_t i = 0; i < bvh.header->node_count; ++i)
    for (std::uint32_t child : bvh.nodes[i].child)
      if (!(child & kLeafBit)) depth[child] = depth[i] + 1;
  std::uint32_t deepest = *std::max_element(depth.begin(), depth.end());
  CHECK(deepest <= kBvhDepthMax);
  CHECK(deepest > kBvhDepthMax - 14);  // the maximum for ranges that need 11 levels for their treelets
}

// Goal: the same tree on every CPU, with every compiler and library. Method: hashes of trees whose builds divide
// ranges, sweep treelets and break ties.
TEST_CASE("bvh_is_the_same_tree_everywhere") {
  CHECK(hash_of(*make_world(ordered_cloud(3000), &kBvhAccel)) == 11288840811611591648u);
  CHECK(hash_of(*make_world(lattice_box(12), &kBvhAccel)) == 17093041408473538993u);
  CHECK(hash_of(*make_world(duplicates("", 1000), &kBvhAccel)) == 4844613320998837954u);
}
