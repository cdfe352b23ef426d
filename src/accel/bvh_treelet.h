// The lower end of the BVH: subtrees of few triangles, built with care.
#pragma once
#include "accel/bvh_primitive.h"

namespace pocketray {

constexpr std::uint32_t kTreeletMax = 64;  // triangles
constexpr std::uint32_t kTreeletLeafMax = kTreeletMax / 2;
constexpr std::uint32_t kTreeletNodeMax = 2 * kTreeletLeafMax;

// A binary tree over the primitives order[begin .. begin + count).
struct TreeletNode {
  WideBox box;
  std::uint32_t begin, count, leaf_max;
  std::uint32_t left, right;   // 0: a leaf
  double cost[5];              // of showing the subtree as one root (1) or up to 2, 3, 4 of them
  std::uint8_t left_roots[5];  // of these roots, how many stand for the left half; [1]: of four, beneath the one
};

struct Treelet {
  const BuildPrimitive* primitives;
  std::uint32_t node_count;
  TreeletNode nodes[kTreeletNodeMax];
  std::uint8_t order[3][kTreeletMax];  // primitives by centroid on each axis
};

// Splits up to kTreeletMax primitives down to leaves, of which there are at most leaf_max.
void build_treelet(const BuildPrimitive* primitives, std::uint32_t count, std::uint32_t leaf_max, Treelet* treelet);

// The up to four nodes of the treelet that become the children of one BvhNode for the subtree at `node`.
std::uint32_t treelet_children(const Treelet& treelet, std::uint32_t node, std::uint32_t children[4]);

}  // namespace pocketray
