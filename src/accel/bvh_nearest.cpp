// Distance from a point to the nearest triangle.
#include <limits>

#include "accel/bvh.h"
#include "accel/point_distance.h"
#include "base/check.h"

namespace pocketray {
namespace {

struct Entry {
  std::uint32_t child;
  double squared;
};

double squared_box_distance(const Vec3d& p, const Box& box) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double below = box.low[axis] - p[axis], above = p[axis] - box.high[axis];
    double d = below > 0 ? below : above > 0 ? above : 0;
    sum += d * d;
  }
  return sum;
}

double squared_leaf_distance(const Vec3d& p, const TriangleBlock& block, std::uint32_t count) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    Vec3 v[3];
    for (int i = 0; i < 3; ++i) v[i] = block_vertex(block, i, static_cast<int>(lane));
    if (is_degenerate(v[0], v[1], v[2])) continue;
    double d = squared_distance(p, to_double(v[0]), to_double(v[1]), to_double(v[2]));
    if (d < least) least = d;
  }
  return least;
}

}  // namespace

float bvh_nearest_distance(const LeafKind& kind, const Accel& accel, const Vec3& point) {
  if (!is_finite(point)) return 0;
  CHECK_LE(bvh_bytes(1, 0), accel.data.bytes());
  BvhView bvh(accel.data.data);
  Vec3d p = to_double(point);
  double least = std::numeric_limits<double>::infinity();
  Entry stack[kBvhStackSize];
  int top = 0;
  stack[top++] = {0, 0};
  while (top > 0) {
    Entry entry = stack[--top];
    if (entry.squared > least) continue;
    if (entry.child & kLeafBit) {
      TriangleBlock scratch;
      const std::uint8_t* leaf = leaf_at(kind, accel.data.data, entry.child & kLeafIndexMask);
      double d = squared_leaf_distance(p, kind.block(accel, leaf, &scratch), leaf_triangle_count(entry.child));
      if (d < least) least = d;
      continue;
    }
    const BvhNode& node = bvh.nodes[entry.child];
    int first = top;
    for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
      double d = squared_box_distance(p, child_box(node, lane));
      int place = top++;
      for (; place > first && stack[place - 1].squared < d; --place) stack[place] = stack[place - 1];
      stack[place] = {node.child[lane], d};
    }
  }
  return distance_bound(least, accel.bounds);
}

}  // namespace pocketray
