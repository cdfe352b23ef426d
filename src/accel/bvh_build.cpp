// Builds the BVH from the top: a node takes the whole range of its triangles and splits the part with the largest
// surface until it has four or nothing is left to split. Where to split is decided by the surface-area heuristic, over
// bins [Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies"] in large ranges, over all sorted
// positions in small ones.
//
// Ours: cost is counted in leaves of four, and a split that leaves fewer than kFreeSplitMin triangles on a side has to
// leave one side with a multiple of four. So leaves are full but for few (the bound is in leaf_count_max()), which
// keeps the memory below a bound that can be planned with.
#include <algorithm>
#include <cstring>
#include <limits>

#include "accel/bvh.h"
#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kBinCount = 16;
constexpr std::uint32_t kSweepMax = 64;      // ranges up to this are sorted instead of binned
constexpr std::uint32_t kFreeSplitMin = 32;  // sides from this on may have any count
static_assert(kFreeSplitMin % kBvhLeafSize == 0 && kSweepMax % kBvhLeafSize == 0, "aligned splits");

struct Primitive {
  Box box;
  std::uint32_t triangle;
};

struct Range {
  std::uint32_t begin, end;  // in the primitives
  Box box;
  std::uint32_t count() const { return end - begin; }
};

struct Task {
  Range range;
  std::uint32_t node, depth;
};

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = -1;  // −1: there is none
  std::uint32_t left_count = 0;
};

// An aligned subtree of n triangles has ceil(n/4) leaves; every free split makes two subtrees of at least
// kFreeSplitMin.
constexpr std::size_t leaf_count_max(std::size_t triangles) {
  return triangles / kBvhLeafSize + triangles / kFreeSplitMin + 1;
}
// With L leaves Σ(children − 1) = L − 1 over the nodes, and a node of two or three children has leaves alone.
constexpr std::size_t node_count_max(std::size_t leaves) { return 2 * leaves / 3 + 1; }

// The double area neither overflows nor underflows for any float coordinates.
double half_area_exact(const Box& b) {
  double x = double(b.high.x) - b.low.x, y = double(b.high.y) - b.low.y, z = double(b.high.z) - b.low.z;
  return x * y + y * z + z * x;
}
double leaf_cost(std::uint32_t triangles) { return (triangles + kBvhLeafSize - 1) / kBvhLeafSize; }
double side_cost(const Box& box, std::uint32_t triangles) { return half_area_exact(box) * leaf_cost(triangles); }

// Twice the centre: exact enough to sort by, and finite.
float centroid2(const Primitive& p, int axis) { return p.box.low[axis] + p.box.high[axis]; }

struct CentroidLess {
  int axis;
  bool operator()(const Primitive& a, const Primitive& b) const {
    float ca = centroid2(a, axis), cb = centroid2(b, axis);
    return ca != cb ? ca < cb : a.triangle < b.triangle;
  }
};

bool split_is_allowed(std::uint32_t left, std::uint32_t right) {
  if (left == 0 || right == 0) return false;
  return left % kBvhLeafSize == 0 || right % kBvhLeafSize == 0 || (left >= kFreeSplitMin && right >= kFreeSplitMin);
}

// The nearest allowed count to the left of a split that the heuristic wants at `left` of `count`.
std::uint32_t aligned_left_count(std::uint32_t left, std::uint32_t count) {
  if (split_is_allowed(left, count - left)) return left;
  std::uint32_t rounded = (left + kBvhLeafSize / 2) / kBvhLeafSize * kBvhLeafSize;
  std::uint32_t last = (count - 1) / kBvhLeafSize * kBvhLeafSize;
  return std::min(std::max(rounded, kBvhLeafSize), last);
}

// Small ranges: all three axes sorted, all positions that fill leaves.
Split sweep_split(Primitive* primitives, std::uint32_t count) {
  Split best;
  double right_cost[kSweepMax];
  for (int axis = 0; axis < 3; ++axis) {
    std::sort(primitives, primitives + count, CentroidLess{axis});
    Box box = empty_box();
    for (std::uint32_t i = count; i-- > 1;) {
      box = merge(box, primitives[i].box);
      right_cost[i] = side_cost(box, count - i);
    }
    box = empty_box();
    for (std::uint32_t left = 1; left < count; ++left) {
      box = merge(box, primitives[left - 1].box);
      if (left % kBvhLeafSize != 0 && (count - left) % kBvhLeafSize != 0) continue;
      double cost = side_cost(box, left) + right_cost[left];
      if (cost < best.cost) best = {cost, axis, left};
    }
  }
  return best;
}

struct Bins {
  Box box[3][kBinCount];
  std::uint32_t count[3][kBinCount];
};

// Maps centroids to bins; scale is 0 on an axis where all centroids agree.
struct BinMap {
  Vec3 low, scale;
  std::uint32_t bin(const Primitive& p, int axis) const {
    float position = (centroid2(p, axis) - low[axis]) * scale[axis];
    return std::min(static_cast<std::uint32_t>(position), kBinCount - 1);
  }
};

BinMap make_bin_map(const Primitive* primitives, std::uint32_t count) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  BinMap map = {{inf, inf, inf}, {0, 0, 0}};
  Vec3 high = {-inf, -inf, -inf};
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec3 c = primitives[i].box.low + primitives[i].box.high;
    map.low = min(map.low, c), high = max(high, c);
  }
  for (int axis = 0; axis < 3; ++axis) {
    float scale = kBinCount / (high[axis] - map.low[axis]);  // infinite where the extent is 0 or denormal
    map.scale[axis] = high[axis] > map.low[axis] && scale <= std::numeric_limits<float>::max() ? scale : 0;
  }
  return map;
}

Split bin_split(const Primitive* primitives, std::uint32_t count, const BinMap& map) {
  Bins bins;
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t i = 0; i < kBinCount; ++i) bins.box[axis][i] = empty_box(), bins.count[axis][i] = 0;
  for (std::uint32_t i = 0; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      std::uint32_t bin = map.bin(primitives[i], axis);
      bins.box[axis][bin] = merge(bins.box[axis][bin], primitives[i].box);
      ++bins.count[axis][bin];
    }
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    if (map.scale[axis] == 0) continue;
    double right_cost[kBinCount];
    Box box = empty_box();
    std::uint32_t right = 0;
    for (std::uint32_t i = kBinCount; i-- > 1;) {
      box = merge(box, bins.box[axis][i]), right += bins.count[axis][i];
      right_cost[i] = right ? side_cost(box, right) : 0;
    }
    box = empty_box();
    std::uint32_t left = 0;
    for (std::uint32_t i = 1; i < kBinCount; ++i) {
      box = merge(box, bins.box[axis][i - 1]), left += bins.count[axis][i - 1];
      if (left == 0 || left == count) continue;
      double cost = side_cost(box, left) + right_cost[i];
      if (cost < best.cost) best = {cost, axis, left};
    }
  }
  return best;
}

Box range_box(const Primitive* primitives, std::uint32_t count) {
  Box box = empty_box();
  for (std::uint32_t i = 0; i < count; ++i) box = merge(box, primitives[i].box);
  return box;
}

int widest_axis(const Box& box) {
  Vec3 e = extent(box);
  return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
}

// Splits a range of more than a leaf in two. `halve` asks for equal counts, whatever the heuristic says.
void split_range(Primitive* all, const Range& range, bool halve, Range* left, Range* right) {
  Primitive* primitives = all + range.begin;
  std::uint32_t count = range.count();
  Split split;
  if (!halve) {
    if (count <= kSweepMax) {
      split = sweep_split(primitives, count);
    } else {
      split = bin_split(primitives, count, make_bin_map(primitives, count));
    }
  }
  if (split.axis < 0) split.axis = widest_axis(range.box), split.left_count = count / 2;
  std::uint32_t middle = aligned_left_count(split.left_count, count);
  std::nth_element(primitives, primitives + middle, primitives + count, CentroidLess{split.axis});
  *left = {range.begin, range.begin + middle, range_box(primitives, middle)};
  *right = {range.begin + middle, range.end, range_box(primitives + middle, count - middle)};
}

// Levels of nodes under which n triangles surely fit when every range is halved: two halvings a level, rounding
// included.
std::uint32_t levels_when_halved(std::uint32_t n) {
  std::uint32_t levels = 1;
  for (std::uint64_t capacity = 2 * kBvhLeafSize; capacity < n; capacity *= 3) ++levels;
  return levels;
}

// The part to split next: the one on which most work is spent, its surface times its triangles, or the one with the
// most triangles when the depth runs out. −1 where all are leaves.
int part_to_split(const Range* parts, int count, bool halve) {
  int best = -1;
  double best_weight = -1;
  for (int i = 0; i < count; ++i) {
    if (parts[i].count() <= kBvhLeafSize) continue;
    double weight = halve ? parts[i].count() : half_area_exact(parts[i].box) * parts[i].count();
    if (weight > best_weight || (weight == best_weight && parts[i].count() > parts[best].count()))
      best = i, best_weight = weight;
  }
  return best;
}

struct Builder {
  const Accel* accel;
  Primitive* primitives;
  BvhNode* nodes;
  TriangleBlock* leaves;
  std::size_t node_max, leaf_max;
  std::uint32_t node_count, leaf_count;
};

// Splits the task's range into the children of its node; the inner ones become tasks, of which the last is met next.
std::uint32_t build_node(Builder* builder, const Task& task, Task* stack, std::uint32_t stack_count) {
  Range parts[4] = {task.range};
  int part_count = task.range.count() > 0;
  bool halve = task.depth + levels_when_halved(task.range.count()) >= kBvhDepthMax;
  for (int i; part_count < 4 && (i = part_to_split(parts, part_count, halve)) >= 0; ++part_count) {
    Range whole = parts[i];
    split_range(builder->primitives, whole, halve, &parts[i], &parts[part_count]);
  }
  BvhNode& node = builder->nodes[task.node];
  for (int lane = 0; lane < 4; ++lane) {
    node.reserved[lane] = 0;
    node.child[lane] = kNoChild;
    set_child_box(&node, lane, empty_box());
    if (lane >= part_count) continue;
    const Range& part = parts[lane];
    if (part.count() > kBvhLeafSize) {
      CHECK_LT(builder->node_count, builder->node_max);
      node.child[lane] = builder->node_count++;
      set_child_box(&node, lane, part.box);
      stack[stack_count++] = {part, node.child[lane], task.depth + 1};
    } else {
      CHECK_LT(builder->leaf_count, builder->leaf_max);
      std::uint32_t ids[kBvhLeafSize];
      for (std::uint32_t i = 0; i < part.count(); ++i) ids[i] = builder->primitives[part.begin + i].triangle;
      node.child[lane] = leaf_reference(builder->leaf_count, part.count());
      set_child_box(&node, lane,
                    gather_leaf(builder->accel->positions, builder->accel->triangles, ids, part.count(),
                                &builder->leaves[builder->leaf_count++]));
    }
  }
  return stack_count;
}

void build_nodes(Builder* builder, const Range& root) {
  Task stack[3 * kBvhDepthMax + 4];
  std::uint32_t stack_count = 0;
  builder->node_count = 1, builder->leaf_count = 0;
  stack[stack_count++] = {root, 0, 1};
  while (stack_count > 0) {
    Task task = stack[--stack_count];
    CHECK_LE(task.depth, kBvhDepthMax);
    stack_count = build_node(builder, task, stack, stack_count);
  }
}

// The boxes of all triangles that have vertices to speak of. Degenerate ones are kept: they may open up when refitted.
std::uint32_t collect_primitives(const Accel& accel, Primitive* primitives, Box* bounds) {
  std::uint32_t count = 0;
  *bounds = empty_box();
  for (std::uint32_t i = 0; i < accel.triangles.count; ++i) {
    const Triangle& triangle = accel.triangles[i];
    if (!has_valid_vertices(accel.positions, triangle)) continue;
    Box box = empty_box();
    for (std::uint32_t vertex : triangle.vertex) box = merge(box, accel.positions[vertex]);
    primitives[count++] = {box, i};
    *bounds = merge(*bounds, box);
  }
  return count;
}

}  // namespace

std::size_t bvh_need(std::uint32_t triangle_count) {
  std::size_t leaves = leaf_count_max(triangle_count);
  return arena_need(bvh_bytes(node_count_max(leaves), leaves));
}
std::size_t bvh_scratch_need(std::uint32_t triangle_count) { return arena_need<Primitive>(triangle_count); }

void bvh_build(Accel* accel, Arena* keep, Arena* scratch) {
  std::uint32_t triangle_count = accel->triangles.count;
  CHECK_LE(triangle_count, kTriangleCountMax);
  std::size_t scratch_mark = arena_mark(*scratch), keep_mark = arena_mark(*keep);
  Primitive* primitives = arena_array<Primitive>(scratch, triangle_count).data;
  Range root = {0, 0, empty_box()};
  root.end = collect_primitives(*accel, primitives, &root.box);

  std::size_t leaf_max = leaf_count_max(root.count()), node_max = node_count_max(leaf_max);
  std::uint8_t* data = static_cast<std::uint8_t*>(arena_allocate(keep, bvh_bytes(node_max, leaf_max)));
  Builder builder = {accel,
                     primitives,
                     reinterpret_cast<BvhNode*>(data + bvh_bytes(0, 0)),
                     reinterpret_cast<TriangleBlock*>(data + bvh_bytes(node_max, 0)),
                     node_max,
                     leaf_max,
                     0,
                     0};
  build_nodes(&builder, root);

  std::size_t bytes = bvh_bytes(builder.node_count, builder.leaf_count);
  CHECK_LE(bytes, 0xFFFFFFFFu);
  std::memmove(data + bvh_bytes(builder.node_count, 0), builder.leaves, sizeof(TriangleBlock) * builder.leaf_count);
  *reinterpret_cast<BvhHeader*>(data) = {kBvhMagic, triangle_count, builder.node_count, builder.leaf_count, {0}};
  arena_release(keep, keep_mark);
  arena_allocate(keep, bytes);
  arena_release(scratch, scratch_mark);
  accel->data = {data, static_cast<std::uint32_t>(bytes)};
  accel->bounds = node_box(*BvhView(data).nodes);
}

}  // namespace pocketray
