#include "accel/bvh_treelet.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct SweepSplit {
  double cost = kInfinite;
  int axis = 0;
  std::uint32_t left_count = 0;
};

// Unsigned integers that sort as the floats do.
std::uint32_t sort_key(float f) {
  std::uint32_t bits;
  f += 0.0f;  // -0 is 0
  std::memcpy(&bits, &f, sizeof bits);
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

void sort_primitives(Treelet* treelet, std::uint32_t count) {
  std::uint64_t keys[kTreeletMax];
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < count; ++i)
      keys[i] = std::uint64_t(sort_key(centroid2(treelet->primitives[i], axis))) << 32 | i;
    std::sort(keys, keys + count);
    for (std::uint32_t i = 0; i < count; ++i) treelet->order[axis][i] = static_cast<std::uint8_t>(keys[i]);
  }
}

// Whether a split leaves full leaves, and lets nodes be full. The latter: as a forest of k roots with k = L modulo 3 a
// subtree of L leaves needs (L - k) / 3 nodes of four children and none else. Its halves can always be such forests
// with k roots together, but where one L is a multiple of three and the other one is that or leaves the remainder two.
bool split_is_full(std::uint32_t left, std::uint32_t right) {
  std::uint32_t left_leaves = leaves_for(left), right_leaves = leaves_for(right);
  if (left_leaves + right_leaves != leaves_for(left + right)) return false;
  return left_leaves % 3 == 1 || right_leaves % 3 == 1 || (left_leaves % 3 == 2 && right_leaves % 3 == 2);
}

// The cheapest full split of a node, among all positions on all axes. There is one: four primitives on the left.
SweepSplit sweep(const Treelet& treelet, const TreeletNode& node) {
  SweepSplit best;
  double right_cost[kTreeletMax];
  bool allowed[kTreeletMax];
  std::uint32_t count = node.count;
  for (std::uint32_t left = 1; left < count; ++left) allowed[left] = split_is_full(left, count - left);
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint8_t* order = treelet.order[axis] + node.begin;
    WideBox box = empty_wide_box();
    for (std::uint32_t i = count; i-- > 1;) {
      box = merge(box, wide_box(treelet.primitives[order[i]]));
      if (allowed[i]) right_cost[i] = part_cost(box, count - i);
    }
    box = empty_wide_box();
    for (std::uint32_t left = 1; left < count; ++left) {
      box = merge(box, wide_box(treelet.primitives[order[left - 1]]));
      if (!allowed[left]) continue;
      double cost = part_cost(box, left) + right_cost[left];
      if (cost < best.cost) best.cost = cost, best.axis = axis, best.left_count = left;
    }
  }
  return best;
}

// Brings the primitives of the left half to the front in the orders of all axes.
void partition_orders(Treelet* treelet, const TreeletNode& node, const SweepSplit& split) {
  std::uint8_t in_left[kTreeletMax] = {0};
  for (std::uint32_t i = 0; i < split.left_count; ++i) in_left[treelet->order[split.axis][node.begin + i]] = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == split.axis) continue;
    std::uint8_t* order = treelet->order[axis] + node.begin;
    std::uint8_t right[kTreeletMax];
    std::uint32_t left_count = 0, right_count = 0;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      std::uint8_t id = order[i];
      std::uint8_t is_left = in_left[id];
      order[left_count] = id, right[right_count] = id;
      left_count += is_left, right_count += 1u - is_left;
    }
    std::memcpy(order + left_count, right, right_count);
  }
}

std::uint32_t add_node(Treelet* treelet, std::uint32_t begin, std::uint32_t count) {
  CHECK_LT(treelet->node_count, 2 * kTreeletLeafMax - 1);
  TreeletNode& node = treelet->nodes[treelet->node_count];
  node.begin = begin, node.count = count, node.left = node.right = 0;
  node.box = empty_wide_box();
  for (std::uint32_t i = begin; i < begin + count; ++i)
    node.box = merge(node.box, wide_box(treelet->primitives[treelet->order[0][i]]));
  return treelet->node_count++;
}

void split_node(Treelet* treelet, TreeletNode* node) {
  SweepSplit split = sweep(*treelet, *node);
  partition_orders(treelet, *node, split);
  node->left = add_node(treelet, node->begin, split.left_count);
  node->right = add_node(treelet, node->begin + split.left_count, node->count - split.left_count);
}

// The cheapest ways to stand for a subtree by one to four roots, from those of its halves [Wald, Benthin & Boulos 2008,
// "Getting Rid of Packets", sec. 3.2].
void choose_roots(TreeletNode* node, const Treelet& treelet, double node_price) {
  double area = half_area(node->box);
  if (node->left == 0) {
    for (int roots = 1; roots <= 4; ++roots) node->cost[roots] = area, node->left_roots[roots] = 0;
    return;
  }
  const TreeletNode &left = treelet.nodes[node->left], &right = treelet.nodes[node->right];
  double split_cost[5];
  std::uint8_t split_left[5];
  for (int roots = 2; roots <= 4; ++roots) {
    split_cost[roots] = kInfinite;
    for (int i = 1; i < roots; ++i) {
      double cost = left.cost[i] + right.cost[roots - i];
      if (cost < split_cost[roots]) split_cost[roots] = cost, split_left[roots] = static_cast<std::uint8_t>(i);
    }
  }
  node->cost[1] = area + node_price + split_cost[4];
  node->left_roots[1] = split_left[4];
  for (int roots = 2; roots <= 4; ++roots) {
    bool whole = node->cost[1] <= split_cost[roots];
    node->cost[roots] = whole ? node->cost[1] : split_cost[roots];
    node->left_roots[roots] = whole ? 0 : split_left[roots];
  }
}

void add_children(const Treelet& treelet, std::uint32_t index, std::uint32_t roots, std::uint32_t children[4],
                  std::uint32_t* count) {
  const TreeletNode& node = treelet.nodes[index];
  if (roots == 1 || node.left_roots[roots] == 0) {
    children[(*count)++] = index;
    return;
  }
  add_children(treelet, node.left, node.left_roots[roots], children, count);
  add_children(treelet, node.right, roots - node.left_roots[roots], children, count);
}

}  // namespace

void build_treelet(const BuildPrimitive* primitives, std::uint32_t count, Treelet* treelet) {
  CHECK_GT(count, 0u);
  CHECK_LE(count, kTreeletMax);
  treelet->primitives = primitives, treelet->node_count = 0;
  sort_primitives(treelet, count);
  add_node(treelet, 0, count);
  for (std::uint32_t i = 0; i < treelet->node_count; ++i)
    if (treelet->nodes[i].count > kBvhLeafSize) split_node(treelet, &treelet->nodes[i]);
  // More than all surfaces of the treelet together: the fewest nodes first, then the least surface.
  double node_price = half_area(treelet->nodes[0].box) * (2 * kTreeletLeafMax);
  for (std::uint32_t i = treelet->node_count; i-- > 0;) choose_roots(&treelet->nodes[i], *treelet, node_price);
}

std::uint32_t treelet_children(const Treelet& treelet, std::uint32_t index, std::uint32_t children[4]) {
  const TreeletNode& node = treelet.nodes[index];
  if (node.left == 0) return children[0] = index, 1;
  std::uint32_t count = 0;
  add_children(treelet, node.left, node.left_roots[1], children, &count);
  add_children(treelet, node.right, 4 - node.left_roots[1], children, &count);
  return count;
}

}  // namespace pocketray
