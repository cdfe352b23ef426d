// Adapts a BVH in place to vertices that have moved.
#include "accel/bvh.h"
#include "accel/denormals.h"
#include "base/check.h"

namespace pocketray {

void bvh_refit(const LeafKind& kind, Accel* accel, Array<std::uint8_t> data) {
  CHECK_LE(bvh_bytes(1, 0), data.bytes());
  CHECK_EQ(reinterpret_cast<std::uintptr_t>(data.data) % alignof(BvhNode), 0u);
  BvhWritableView bvh(data.data);
  CHECK_EQ(bvh.header->triangle_count, accel->triangles.count);
  CHECK_EQ(bvh.header->magic, kind.magic);
  CHECK_EQ(data.bytes(), bvh_bytes(bvh.header->node_count, bvh.header->leaf_count, kind.bytes));
  std::uint8_t* leaves = data.data + bvh_bytes(bvh.header->node_count, 0);
  // Children come after their parents: from the last node to the first, every child is updated before its parent.
  for (std::uint32_t i = bvh.header->node_count; i-- > 0;) {
    BvhNode& node = bvh.nodes[i];
    for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
      std::uint32_t child = node.child[lane];
      if (child & kLeafBit) {
        std::uint8_t* leaf = leaves + std::size_t(kind.bytes) * (child & kLeafIndexMask);
        std::uint32_t ids[kBvhLeafSize], count = leaf_triangle_count(child);
        for (std::uint32_t k = 0; k < count; ++k) ids[k] = leaf_ids(kind, leaf)[k] & ~kUnhittableBit;
        set_child_box(&node, lane, kind.fill(accel->positions, accel->triangles, ids, count, leaf));
      } else {
        set_child_box(&node, lane, node_box(bvh.nodes[child]));
      }
    }
  }
  accel->data = data;
  accel->bounds = node_box(bvh.nodes[0]);
  accel->least_coordinate = least_coordinate(accel->positions);
}

}  // namespace pocketray
