// The lower levels of the BVH: small subtrees, divided carefully into full leaves and collapsed into the fewest nodes.
#pragma once
#include "accel/bvh_primitive.h"

namespace pocketray {

constexpr std::uint32_t kTreeletMax = 128;  // triangles
constexpr std::uint32_t kTreeletLeafMax = leaves_for(kTreeletMax);

// Upper bound of the nodes that a treelet of L leaves becomes (one for a single leaf), whatever its triangles; proved
// in bvh_treelet.cpp. With four children in every node it would be (L - 1) / 3.
constexpr std::size_t treelet_node_count(std::size_t leaves) { return leaves > 1 ? (leaves + 1) / 3 : 1; }

// Cost of a subtree as a given number of roots: nodes at and below the roots, and their surface.
struct TreeletCost {
  std::uint32_t node_count;
  double surface;
};

// A node of a binary tree.
struct TreeletNode {
  WideBox box;
  std::uint32_t begin, count;  // order[0][begin .. begin + count) are its primitives
  std::uint32_t left, right;   // nodes; 0 in a leaf
  // Cost of the subtree as one root or as up to two, three, four roots, and how many of these belong to the left half
  // (0: the subtree is one root). Entry 1 has the left-hand count of the four children of the single root.
  TreeletCost cost[5];
  std::uint8_t left_roots[5];
};

struct Treelet {
  const BuildPrimitive* primitives;
  std::uint32_t node_count;
  TreeletNode nodes[2 * kTreeletLeafMax - 1];  // the root first
  std::uint8_t order[3][kTreeletMax];  // indices of primitives, sorted by centroid on each axis within every node
};
static_assert(kTreeletMax <= 256, "indices are bytes");

// Divides primitives[0 .. count) into leaves_for(count) leaves; 0 < count <= kTreeletMax. The primitives must outlive
// the treelet.
void build_treelet(const BuildPrimitive* primitives, std::uint32_t count, Treelet* treelet);

// Lists the one to four nodes of the treelet that become the children of the BvhNode of the subtree at `node`.
std::uint32_t treelet_children(const Treelet& treelet, std::uint32_t node, std::uint32_t children[4]);

}  // namespace pocketray
