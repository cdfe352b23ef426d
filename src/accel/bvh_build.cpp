// Builds the BVH top down: a node takes a range of triangles and divides the part with the largest surface until it has
// four parts. Small ranges become treelets, each of several nodes built at once.
//
// Ours: every range has a budget of leaves, slightly more than its triangles fill, and no division exceeds it. This
// bounds the memory to plan for.
#include <algorithm>
#include <cstring>
#include <limits>

#include "accel/bvh_divide.h"
#include "accel/bvh_treelet.h"
#include "accel/denormals.h"
#include "base/check.h"

namespace pocketray {
namespace {

struct Task {
  BuildPart part;
  std::uint32_t node, depth;
};

// Spare leaves, because not all hold four; measured with bench_embree.
constexpr std::uint32_t kTrianglesPerSpareLeaf = 128;

constexpr std::size_t leaf_count_max(std::size_t triangles) {
  return leaves_for(static_cast<std::uint32_t>(triangles)) + triangles / kTrianglesPerSpareLeaf;
}
// Nodes above the treelets have four children; their subtrees end in treelets or leaves. With E ends there are (E - 1)
// / 3 such nodes. An end of L leaves accounts for treelet_node_count(L) nodes (none for a leaf among such nodes) and a
// third of a node above; for the values of L that occur, 1 and at least 4, the sum is at most 7/15 L. If the root is a
// treelet, it is all there is. None of this depends on where triangles lie: part_to_divide() finds a part to divide
// until there are four, divide_part() finds a division of it, and only the remaining choices depend on the boxes.
constexpr std::size_t node_count_max(std::size_t leaves) { return 7 * leaves / 15 + 1; }
constexpr bool ends_are_bounded() {
  for (std::size_t leaves = kSideLeavesMin; leaves <= kTreeletLeafMax; ++leaves)
    if (15 * (3 * treelet_node_count(leaves) + 1) > 3 * 7 * leaves) return false;
  for (std::size_t leaves = 0; leaves <= kTreeletLeafMax; ++leaves)
    if (treelet_node_count(leaves) > node_count_max(leaves)) return false;
  return true;
}
static_assert(ends_are_bounded(), "as above");
static_assert(kSideLeavesMin < kTreeletLeafMax / 3, "of three parts larger than a treelet, one can be divided");
static_assert(bvh_bytes(node_count_max(leaf_count_max(kTriangleCountMax)), leaf_count_max(kTriangleCountMax)) +
                      2 * kArenaAlignment <=
                  0xFFFFFFFFu,
              "fits into a 32-bit address space");

// Number of levels of nodes that always suffices for n triangles when every range is halved: two halvings per level,
// including rounding.
std::uint32_t levels_when_halved(std::uint32_t n) {
  std::uint32_t levels = static_cast<std::uint32_t>(treelet_node_count(kTreeletLeafMax));
  for (std::uint64_t capacity = kTreeletMax; capacity < n; capacity *= 3) ++levels;
  return levels;
}

// Returns the part to divide next: the one with the largest surface, or with the most triangles when ranges are halved.
// -1 if none can be divided, which never happens with fewer than four parts larger than a treelet.
int part_to_divide(const BuildPart* parts, int count, bool halve) {
  int best = -1;
  double best_weight = -1;
  for (int i = 0; i < count; ++i) {
    std::uint32_t n = parts[i].count;
    if (!can_be_divided(n)) continue;
    double weight = halve ? n : half_area(parts[i].box);
    if (weight > best_weight || (weight == best_weight && n > parts[best].count)) best = i, best_weight = weight;
  }
  return best;
}

struct Builder {
  const LeafKind& kind;
  const Accel* accel;
  BuildPrimitive* primitives;
  BvhNode* nodes;
  std::uint8_t* leaves;
  std::size_t node_max, leaf_max;
  std::uint32_t node_count, leaf_count;
  Treelet treelet;
};

BvhNode* clear_node(Builder* builder, std::uint32_t index) {
  BvhNode* node = &builder->nodes[index];
  node->still = 0;
  for (std::uint32_t& word : node->reserved) word = 0;
  for (int lane = 0; lane < 4; ++lane) {
    node->child[lane] = kNoChild;
    set_child_box(node, lane, no_child_box());
  }
  return node;
}

std::uint32_t add_node(Builder* builder) {
  CHECK_LT(builder->node_count, builder->node_max);
  CHECK_LT(builder->node_count, kLeafBit);
  return builder->node_count++;
}

void set_leaf(Builder* builder, BvhNode* node, int lane, const std::uint32_t* ids, std::uint32_t count) {
  CHECK_LT(builder->leaf_count, builder->leaf_max);
  CHECK(lane >= 0 && lane < 4);
  node->child[lane] = leaf_reference(builder->leaf_count, count);
  std::uint8_t* leaf = builder->leaves + std::size_t(builder->kind.bytes) * builder->leaf_count++;
  set_child_box(node, lane, builder->kind.fill(builder->accel->positions, builder->accel->triangles, ids, count, leaf));
}

void set_inner(BvhNode* node, int lane, std::uint32_t child, const WideBox& wide) {
  alignas(16) float low[4], high[4];
  store(low, wide.low), store(high, wide.high);
  node->child[lane] = child;
  set_child_box(node, lane, {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
}

// Writes the nodes of a treelet, whose root becomes node `root`.
void build_lower(Builder* builder, const BuildPart& part, std::uint32_t root) {
  Treelet& t = builder->treelet;
  const BuildPrimitive* primitives = builder->primitives + part.begin;
  build_treelet(primitives, part.count, &t);
  struct Pair {
    std::uint32_t from, to;
  } stack[kTreeletLeafMax];
  int top = 0;
  stack[top++] = {0, root};
  while (top > 0) {
    Pair pair = stack[--top];
    BvhNode* node = clear_node(builder, pair.to);
    std::uint32_t children[4];
    std::uint32_t count = treelet_children(t, pair.from, children);
    CHECK(count >= 1 && count <= 4);
    CHECK_LE(top + int(count), int(kTreeletLeafMax));
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      const TreeletNode& child = t.nodes[children[lane]];
      if (child.left) {
        set_inner(node, int(lane), add_node(builder), child.box);
        stack[top++] = {children[lane], node->child[lane]};
      } else {
        std::uint32_t ids[kBvhLeafSize];
        CHECK_LE(child.count, kBvhLeafSize);
        for (std::uint32_t i = 0; i < child.count; ++i) ids[i] = triangle_of(primitives[t.order[0][child.begin + i]]);
        set_leaf(builder, node, int(lane), ids, child.count);
      }
    }
  }
}

// Divides the task's range into the children of its node; inner children become tasks, the last of which is next.
std::uint32_t build_node(Builder* builder, const Task& task, Task* stack, std::uint32_t stack_count) {
  if (task.part.count == 0) {
    clear_node(builder, task.node);
    return stack_count;
  }
  if (task.part.count <= kTreeletMax) {
    build_lower(builder, task.part, task.node);
    return stack_count;
  }
  BuildPart parts[4] = {task.part};
  int part_count = 1;
  bool halve = !has_division_axis(task.part) || task.depth + levels_when_halved(task.part.count) >= kBvhDepthMax;
  for (int i; part_count < 4 && (i = part_to_divide(parts, part_count, halve)) >= 0; ++part_count) {
    BuildPart whole = parts[i];
    divide_part(builder->primitives, whole, halve, &parts[i], &parts[part_count]);
  }
  CHECK_LE(stack_count + 4, std::uint32_t(kBvhStackSize));
  BvhNode* node = clear_node(builder, task.node);
  for (int lane = 0; lane < part_count; ++lane) {
    const BuildPart& part = parts[lane];
    if (part.count > kBvhLeafSize) {
      set_inner(node, lane, add_node(builder), part.box);
      stack[stack_count++] = {part, node->child[lane], task.depth + 1};
    } else {
      std::uint32_t ids[kBvhLeafSize];
      for (std::uint32_t i = 0; i < part.count; ++i) ids[i] = triangle_of(builder->primitives[part.begin + i]);
      set_leaf(builder, node, lane, ids, part.count);
    }
  }
  return stack_count;
}

void build_nodes(Builder* builder, const BuildPart& root) {
  Task stack[kBvhStackSize];
  std::uint32_t stack_count = 0;
  builder->node_count = 1, builder->leaf_count = 0;
  stack[stack_count++] = {root, 0, 1};
  while (stack_count > 0) {
    Task task = stack[--stack_count];
    CHECK_LE(task.depth, kBvhDepthMax);
    stack_count = build_node(builder, task, stack, stack_count);
  }
}

// Collects the boxes of all triangles with valid vertices, degenerate ones too: they may become valid in a refit.
std::uint32_t collect_primitives(const Accel& accel, BuildPrimitive* primitives) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < accel.triangles.count; ++i) {
    const Triangle& triangle = accel.triangles[i];
    if (!has_valid_vertices(accel.positions, triangle)) continue;
    Box b = empty_box();
    for (std::uint32_t vertex : triangle.vertices()) b = merge(b, accel.positions[vertex]);
    primitives[count++] = {{b.low.x, b.low.y, b.low.z}, i | kIdTag, {b.high.x, b.high.y, b.high.z}, 0};
  }
  return count;
}

}  // namespace

std::size_t bvh_need(const LeafKind& kind, std::uint32_t triangle_count) {
  std::size_t leaves = leaf_count_max(triangle_count);
  return arena_need(bvh_bytes(node_count_max(leaves), leaves, kind.bytes));
}
std::size_t bvh_scratch_need(std::uint32_t triangle_count) { return arena_need<BuildPrimitive>(triangle_count); }

void bvh_build(const LeafKind& kind, Accel* accel, Arena* keep, Arena* scratch) {
  CHECK(keep != scratch);  // each is released to its own mark
  std::uint32_t triangle_count = accel->triangles.count;
  CHECK_LE(triangle_count, kTriangleCountMax);
  std::size_t scratch_mark = arena_mark(*scratch), keep_mark = arena_mark(*keep);
  BuildPrimitive* primitives = arena_array<BuildPrimitive>(scratch, triangle_count).data;
  std::uint32_t count = collect_primitives(*accel, primitives);
  CHECK_LE(count, triangle_count);
  std::size_t leaf_max = leaf_count_max(count), node_max = node_count_max(leaf_max);
  BuildPart root = make_part(primitives, 0, count, static_cast<std::uint32_t>(leaf_max));

  std::uint8_t* data = static_cast<std::uint8_t*>(arena_allocate(keep, bvh_bytes(node_max, leaf_max, kind.bytes)));
  CHECK_EQ(reinterpret_cast<std::uintptr_t>(data) % alignof(BvhNode), 0u);
  Builder builder = {kind,
                     accel,
                     primitives,
                     reinterpret_cast<BvhNode*>(data + bvh_bytes(0, 0)),
                     data + bvh_bytes(node_max, 0),
                     node_max,
                     leaf_max,
                     0,
                     0,
                     {}};
  build_nodes(&builder, root);

  std::size_t bytes = bvh_bytes(builder.node_count, builder.leaf_count, kind.bytes);
  CHECK_LE(bytes, 0xFFFFFFFFu);
  std::memmove(data + bvh_bytes(builder.node_count, 0), builder.leaves, std::size_t(kind.bytes) * builder.leaf_count);
  *reinterpret_cast<BvhHeader*>(data) = {kind.magic, triangle_count, builder.node_count, builder.leaf_count, {0}};
  arena_release(keep, keep_mark);
  arena_allocate(keep, bytes);
  CHECK_LE(arena_need(bytes), bvh_need(kind, triangle_count));
  arena_release(scratch, scratch_mark);
  accel->data = {data, static_cast<std::uint32_t>(bytes)};
  accel->bounds = node_box(*BvhView(data).nodes);
  accel->least_coordinate = least_coordinate(accel->positions);
}

}  // namespace pocketray
