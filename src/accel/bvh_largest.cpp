// Finds the largest value of a triangle, depth first and the best child first; skips nodes whose box cannot exceed the
// best value so far.
#include <limits>

#include "accel/bvh.h"
#include "base/check.h"

namespace pocketray {
namespace {

struct Entry {
  std::uint32_t child;
  float value;  // upper bound for all triangles below
};

float largest_of_leaf(const LeafKind& kind, const Accel& accel, std::uint32_t child, const TriangleQuery& query) {
  const std::uint32_t* ids = leaf_ids(kind, leaf_at(kind, accel.data.data, child & kLeafIndexMask));
  float most = 0;
  for (std::uint32_t lane = 0; lane < leaf_triangle_count(child); ++lane) {
    const std::uint32_t id = ids[lane] & ~kUnhittableBit;
    if (!is_hittable(accel.positions, accel.triangles[id])) continue;
    const float value = query.triangle_value(query.context, id);
    if (value > most) most = value;
  }
  return most;
}

}  // namespace

float bvh_largest(const LeafKind& kind, const Accel& accel, const TriangleQuery& query) {
  CHECK_LE(bvh_bytes(1, 0), accel.data.bytes());
  CHECK(query.box_value != nullptr && query.triangle_value != nullptr);
  BvhView bvh(accel.data.data);
  float most = 0;
  Entry stack[kBvhStackSize];
  int top = 0;
  stack[top++] = {0, std::numeric_limits<float>::infinity()};
  while (top > 0) {
    const Entry entry = stack[--top];
    if (!(entry.value > most)) continue;
    if (entry.child & kLeafBit) {
      const float value = largest_of_leaf(kind, accel, entry.child, query);
      if (value > most) most = value;
      continue;
    }
    const BvhNode& node = bvh.nodes[entry.child];
    const int first = top;
    for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
      const float value = query.box_value(query.context, child_box(node, lane));
      int place = top++;
      for (; place > first && stack[place - 1].value > value; --place) stack[place] = stack[place - 1];
      stack[place] = {node.child[lane], value};
    }
  }
  return most;
}

}  // namespace pocketray
