// Builds the hierarchy over the reference's triangles by the surface-area heuristic.
#include <limits>

#include "base/box.h"
#include "base/check.h"
#include "desktop/reference/world.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kLeafCountMax = 4, kBinCount = 16, kHalveDepth = 24;

// A triangle during the build.
struct Item {
  Box box;
  std::uint32_t triangle;
};
struct Range {
  std::uint32_t begin, count;
  Box box;
};

int bin_of(float middle, float low, float extent) {
  return static_cast<int>((middle - low) / extent * (kBinCount * 0.99999f));
}

// Least sum of area × count over kBinCount slices of the triangles' centroids along an axis [Wald 2007, "On fast
// Construction of SAH-based Bounding Volume Hierarchies", sec. 3]; *bin is the first on the right side. Infinite if all
// fall into one slice.
double best_slice(const Item* items, std::uint32_t count, const Box& middles, int axis, int* bin) {
  float low = middles.low[axis], extent = middles.high[axis] - low;
  if (!(extent > 0)) return std::numeric_limits<double>::infinity();
  Box boxes[kBinCount];
  std::uint32_t counts[kBinCount] = {};
  for (Box& box : boxes) box = empty_box();
  for (std::uint32_t i = 0; i < count; ++i) {
    int b = bin_of(center(items[i].box)[axis], low, extent);
    boxes[b] = merge(boxes[b], items[i].box);
    ++counts[b];
  }
  double right_cost[kBinCount] = {}, best = std::numeric_limits<double>::infinity();
  Box right = empty_box(), left = empty_box();
  std::uint32_t right_count = 0, left_count = 0;
  for (int b = kBinCount - 1; b > 0; --b) {
    right = merge(right, boxes[b]);
    right_count += counts[b];
    right_cost[b] = static_cast<double>(half_area(right)) * right_count;
  }
  for (int b = 1; b < static_cast<int>(kBinCount); ++b) {
    left = merge(left, boxes[b - 1]);
    left_count += counts[b - 1];
    double cost = static_cast<double>(half_area(left)) * left_count + right_cost[b];
    if (left_count == 0 || left_count == count || !(cost < best)) continue;
    best = cost, *bin = b;
  }
  return best;
}

// Sorts the items of a range into two sides; returns the size of the left one. Halves the range if nothing else divides
// it.
std::uint32_t part(Item* items, std::uint32_t count, bool halve) {
  Box middles = empty_box();
  for (std::uint32_t i = 0; i < count; ++i) middles = merge(middles, center(items[i].box));
  double best = std::numeric_limits<double>::infinity();
  int best_axis = 0, best_bin = 0;
  for (int axis = 0; axis < 3 && !halve; ++axis) {
    int bin = 0;
    double cost = best_slice(items, count, middles, axis, &bin);
    if (cost < best) best = cost, best_axis = axis, best_bin = bin;
  }
  if (!(best < std::numeric_limits<double>::infinity())) return count / 2;
  float low = middles.low[best_axis], extent = middles.high[best_axis] - low;
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (bin_of(center(items[i].box)[best_axis], low, extent) >= best_bin) continue;
    Item item = items[i];
    items[i] = items[left], items[left++] = item;
  }
  return left;
}

Box box_of(const Item* items, std::uint32_t count) {
  Box box = empty_box();
  for (std::uint32_t i = 0; i < count; ++i) box = merge(box, items[i].box);
  return box;
}

// Divides a range into up to four parts, each time splitting the one with the largest area × count.
int part_in_four(Item* items, Range* ranges, bool halve) {
  int count = 1;
  while (count < 4) {
    int largest = -1;
    double most = -1;
    for (int i = 0; i < count; ++i) {
      double cost = static_cast<double>(half_area(ranges[i].box)) * ranges[i].count;
      if (ranges[i].count > kLeafCountMax && cost > most) most = cost, largest = i;
    }
    if (largest < 0) break;
    Range whole = ranges[largest];
    std::uint32_t left = part(items + whole.begin, whole.count, halve);
    CHECK(left > 0 && left < whole.count);
    ranges[largest] = {whole.begin, left, box_of(items + whole.begin, left)};
    ranges[count++] = {whole.begin + left, whole.count - left, box_of(items + whole.begin + left, whole.count - left)};
  }
  return count;
}

ReferenceLeaf make_leaf(const FrameData& frame, const Item* items, std::uint32_t count) {
  CHECK(count >= 1 && count <= kLeafCountMax);
  ReferenceLeaf leaf;
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    leaf.triangle[lane] = lane < count ? items[lane].triangle : kNone;
    for (std::uint32_t i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis)
        leaf.corner[i][axis][lane] =
            lane < count ? frame.geometry.positions[frame.scene->triangles[items[lane].triangle].vertex(i)][axis]
                         : std::numeric_limits<float>::quiet_NaN();
  }
  return leaf;
}

Array<Item> make_items(const FrameData& frame, Arena* arena, ReferenceWorld* world) {
  Array<Item> items = arena_array<Item>(arena, frame.scene->triangles.count);
  for (std::uint32_t i = 0; i < items.count; ++i) {
    items[i] = {empty_box(), i};
    for (std::uint32_t vertex : frame.scene->triangles[i].vertices()) {
      items[i].box = merge(items[i].box, frame.geometry.positions[vertex]);
      for (int axis = 0; axis < 3; ++axis)
        world->magnitude[axis] = std::fmax(world->magnitude[axis], std::fabs(frame.geometry.positions[vertex][axis]));
    }
  }
  return items;
}

}  // namespace

std::size_t reference_world_need(std::uint32_t triangle_count) {
  return arena_need<ReferenceNode>(std::size_t(triangle_count) + 1) + arena_need<ReferenceLeaf>(triangle_count) +
         arena_need<Item>(triangle_count);
}

ReferenceWorld make_reference_world(const FrameData& frame, Arena* arena) {
  ReferenceWorld world;
  world.frame = &frame;
  for (float& m : world.magnitude) m = 0;
  std::uint32_t triangle_count = frame.scene->triangles.count;
  world.nodes = arena_array<ReferenceNode>(arena, std::size_t(triangle_count) + 1);
  world.leaves = arena_array<ReferenceLeaf>(arena, triangle_count);
  world.nodes.count = 1, world.leaves.count = 0;
  std::size_t mark = arena_mark(*arena);
  Array<Item> items = make_items(frame, arena, &world);
  struct Task {
    std::uint32_t node, depth;
    Range range;
  } tasks[3 * kReferenceDepthMax + 1];
  std::uint32_t task_count = 1;
  tasks[0] = {0, 0, {0, triangle_count, box_of(items.data, triangle_count)}};
  while (task_count > 0) {
    Task task = tasks[--task_count];
    CHECK_LT(task.depth, kReferenceDepthMax);
    Range ranges[4] = {task.range};
    int count = part_in_four(items.data, ranges, task.depth >= kHalveDepth);
    ReferenceNode& node = world.nodes[task.node];
    for (int i = 0; i < 4; ++i) {
      Box box = i < count ? ranges[i].box : empty_box();
      for (int axis = 0; axis < 3; ++axis)
        node.bounds[0][axis][i] = box.low[axis], node.bounds[1][axis][i] = box.high[axis];
      node.child[i] = kNone;
      if (i >= count || ranges[i].count == 0) continue;
      if (ranges[i].count <= kLeafCountMax) {
        node.child[i] = world.leaves.count | kReferenceLeafBit;
        world.leaves[world.leaves.count++] = make_leaf(frame, items.data + ranges[i].begin, ranges[i].count);
      } else {
        node.child[i] = world.nodes.count;
        tasks[task_count++] = {world.nodes.count++, task.depth + 1, ranges[i]};
      }
    }
  }
  arena_release(arena, mark);
  CHECK_LE(world.nodes.count, triangle_count + 1);
  CHECK_LE(world.leaves.count, triangle_count);
  return world;
}

}  // namespace pocketray
