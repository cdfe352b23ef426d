#include "accel/bvh_treelet.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "base/float_bits.h"

namespace pocketray {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Nodes of four children are full if the halves of a and b leaves can be forests without empty lanes. A subtree of L
// leaves can be a forest of k roots, k = L modulo 3, with (L - k) / 3 nodes, all of four children. Its halves can
// always be such forests with k roots in total, unless one L is a multiple of three and the other is one, too, or
// leaves the remainder two.
constexpr bool halves_are_full(std::uint32_t a, std::uint32_t b) {
  return a % 3 == 1 || b % 3 == 1 || (a % 3 == 2 && b % 3 == 2);
}

// Proves that a treelet of L leaves becomes at most treelet_node_count(L) nodes, whatever its boxes. nodes[L][r] bounds
// the nodes that a subtree of L leaves needs as up to r roots, for the worst allowed division: choose_roots() takes the
// fewest nodes, with the subtree as one root or its halves with r roots between them.
struct TreeletBound {
  std::uint32_t nodes[kTreeletLeafMax + 1][5] = {};
  constexpr TreeletBound() {
    for (std::uint32_t leaves = 2; leaves <= kTreeletLeafMax; ++leaves) {
      std::uint32_t* most = nodes[leaves];
      for (std::uint32_t left = 1; left < leaves; ++left) {
        if (!halves_are_full(left, leaves - left)) continue;
        for (std::uint32_t roots = 2; roots <= 4; ++roots) {
          std::uint32_t least = ~0u;
          for (std::uint32_t i = 1; i < roots; ++i) {
            std::uint32_t sum = nodes[left][i] + nodes[leaves - left][roots - i];
            least = sum < least ? sum : least;
          }
          most[roots] = least > most[roots] ? least : most[roots];
        }
      }
      most[1] = 1 + most[4];
      for (std::uint32_t roots = 2; roots <= 4; ++roots) most[roots] = most[1] < most[roots] ? most[1] : most[roots];
    }
  }
};
constexpr bool treelets_are_bounded() {
  constexpr TreeletBound bound;
  for (std::uint32_t leaves = 2; leaves <= kTreeletLeafMax; ++leaves)
    if (bound.nodes[leaves][1] > treelet_node_count(leaves)) return false;
  return true;
}
static_assert(treelets_are_bounded(), "for every shape of the binary tree");

struct SweepDivision {
  double cost = kInfinite;
  int axis = 0;
  std::uint32_t left_count = 0;
};

// Unsigned integers that sort like floats.
std::uint32_t sort_key(float f) {
  std::uint32_t bits = float_bits(f + 0.0f);  // -0 is 0
  return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

void sort_primitives(Treelet* treelet, std::uint32_t count) {
  CHECK_LE(count, kTreeletMax);
  std::uint64_t keys[kTreeletMax];
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < count; ++i)
      keys[i] = std::uint64_t(sort_key(centroid2(treelet->primitives[i], axis))) << 32 | i;
    std::sort(keys, keys + count);
    for (std::uint32_t i = 0; i < count; ++i) treelet->order[axis][i] = static_cast<std::uint8_t>(keys[i]);
  }
}

// Returns whether a division leaves full leaves and allows full nodes: see halves_are_full().
bool side_by_side_is_full(std::uint32_t left, std::uint32_t right) {
  std::uint32_t left_leaves = leaves_for(left), right_leaves = leaves_for(right);
  return left_leaves + right_leaves == leaves_for(left + right) && halves_are_full(left_leaves, right_leaves);
}

// Finds the cheapest full division of a node, over all positions on all axes. One exists: four primitives on the left.
SweepDivision sweep(const Treelet& treelet, const TreeletNode& node) {
  SweepDivision best;
  double right_cost[kTreeletMax];
  bool allowed[kTreeletMax];
  std::uint32_t count = node.count;
  for (std::uint32_t left = 1; left < count; ++left) allowed[left] = side_by_side_is_full(left, count - left);
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

// Moves the primitives of the left half to the front of the orders of all axes.
void partition_orders(Treelet* treelet, const TreeletNode& node, const SweepDivision& division) {
  std::uint8_t in_left[kTreeletMax] = {0};
  for (std::uint32_t i = 0; i < division.left_count; ++i) in_left[treelet->order[division.axis][node.begin + i]] = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == division.axis) continue;
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
    CHECK_EQ(left_count, division.left_count);
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

void divide_node(Treelet* treelet, TreeletNode* node) {
  SweepDivision division = sweep(*treelet, *node);
  CHECK(division.left_count > 0 && division.left_count < node->count);
  partition_orders(treelet, *node, division);
  node->left = add_node(treelet, node->begin, division.left_count);
  node->right = add_node(treelet, node->begin + division.left_count, node->count - division.left_count);
}

// Compares the cost of roots: fewest nodes first, which keeps to the planned memory, then least surface. The two are
// not added up: if all boxes are points or lines, there is no surface to weigh nodes by.
bool is_cheaper(const TreeletCost& a, const TreeletCost& b) {
  return a.node_count != b.node_count ? a.node_count < b.node_count : a.surface < b.surface;
}

// Finds the cheapest ways to represent a subtree by one to four roots, given those of its halves [Wald, Benthin &
// Boulos 2008, "Getting Rid of Packets", sec. 3.2].
void choose_roots(TreeletNode* node, const Treelet& treelet) {
  double area = half_area(node->box);
  if (node->left == 0) {
    for (int roots = 1; roots <= 4; ++roots) node->cost[roots] = {0, area}, node->left_roots[roots] = 0;
    return;
  }
  const TreeletNode &left = treelet.nodes[node->left], &right = treelet.nodes[node->right];
  TreeletCost division_cost[5];
  std::uint8_t division_left[5];
  for (int roots = 2; roots <= 4; ++roots)
    for (int i = 1; i < roots; ++i) {
      const TreeletCost &a = left.cost[i], &b = right.cost[roots - i];
      TreeletCost cost = {a.node_count + b.node_count, a.surface + b.surface};
      if (i == 1 || is_cheaper(cost, division_cost[roots]))
        division_cost[roots] = cost, division_left[roots] = static_cast<std::uint8_t>(i);
    }
  node->cost[1] = {1 + division_cost[4].node_count, area + division_cost[4].surface};
  node->left_roots[1] = division_left[4];
  for (int roots = 2; roots <= 4; ++roots) {
    bool whole = !is_cheaper(division_cost[roots], node->cost[1]);
    node->cost[roots] = whole ? node->cost[1] : division_cost[roots];
    node->left_roots[roots] = whole ? 0 : division_left[roots];
  }
}

void add_children(const Treelet& treelet, std::uint32_t index, std::uint32_t roots, std::uint32_t children[4],
                  std::uint32_t* count) {
  CHECK(roots >= 1 && roots <= 4);
  CHECK_LT(*count, 4u);
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
    if (treelet->nodes[i].count > kBvhLeafSize) divide_node(treelet, &treelet->nodes[i]);
  for (std::uint32_t i = treelet->node_count; i-- > 0;) choose_roots(&treelet->nodes[i], *treelet);
  CHECK_LE(treelet->nodes[0].cost[1].node_count, treelet_node_count(leaves_for(count)));
}

std::uint32_t treelet_children(const Treelet& treelet, std::uint32_t index, std::uint32_t children[4]) {
  CHECK_LT(index, treelet.node_count);
  const TreeletNode& node = treelet.nodes[index];
  if (node.left == 0) return children[0] = index, 1;
  std::uint32_t count = 0;
  add_children(treelet, node.left, node.left_roots[1], children, &count);
  add_children(treelet, node.right, 4 - node.left_roots[1], children, &count);
  return count;
}

}  // namespace pocketray
