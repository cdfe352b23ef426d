// The lower end of the BVH: small subtrees, divided with care into full leaves and collapsed into the fewest nodes.
#pragma once
#include "accel/bvh_primitive.h"

namespace pocketray {

constexpr std::uint32_t kTreeletMax = 128;  // triangles
constexpr std::uint32_t kTreeletLeafMax = leaves_for(kTreeletMax);

// A treelet of L leaves becomes at most this many nodes (one where it is a single leaf), whatever its triangles are:
// bvh_treelet.cpp has the proof. With four children in each it would be (L - 1) / 3.
constexpr std::size_t treelet_node_count(std::size_t leaves) { return leaves > 1 ? (leaves + 1) / 3 : 1; }

// What a subtree costs as so many roots: nodes at and below the roots, and their surface.
struct TreeletCost {
  std::uint32_t node_count;
  double surface;
};

// A node of a binary tree.
struct TreeletNode {
  WideBox box;
  std::uint32_t begin, count;  // order[0][begin .. begin + count) are its primitives
  std::uint32_t left, right;   // nodes; 0 in a leaf
  // The subtree as one root or as up to two, three, four of them: what that costs, and how many of the roots stand for
  // the left half (0: the subtree is one root). Entry 1 has the roots on the left of the four beneath the one.
  TreeletCost cost[5];
  std::uint8_t left_roots[5];
};

struct Treelet {
  const BuildPrimitive* primitives;
  std::uint32_t node_count;
  TreeletNode nodes[2 * kTreeletLeafMax - 1];  // the root first
  std::uint8_t order[3][kTreeletMax];          // indices of primitives, by centroid on each axis within every node
};
static_assert(kTreeletMax <= 256, "indices are bytes");

// Splits primitives[0 .. count) down to leaves_for(count) leaves; 0 < count <= kTreeletMax. The primitives must outlive
// the treelet.
void build_treelet(const BuildPrimitive* primitives, std::uint32_t count, Treelet* treelet);

// The nodes of the treelet that become the children of one BvhNode for the subtree at `node`: one to four.
std::uint32_t treelet_children(const Treelet& treelet, std::uint32_t node, std::uint32_t children[4]);

}  // namespace pocketray
