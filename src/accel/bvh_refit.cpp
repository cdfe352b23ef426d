// Gathers the vertices of leaves, and adapts a BVH in place to vertices that have moved.
#include "accel/bvh.h"
#include "base/check.h"

namespace pocketray {

Box gather_leaf(Array<const Vec3> positions, Array<const Triangle> triangles, const std::uint32_t* ids,
                std::uint32_t count, TriangleBlock* block) {
  Box box = empty_box();
  for (std::uint32_t lane = 0; lane < kBvhLeafSize; ++lane) {
    Vec3 p[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    block->triangle[lane] = lane < count ? ids[lane] : kNoTriangle;
    if (lane < count && has_valid_vertices(positions, triangles[ids[lane]])) {
      for (int i = 0; i < 3; ++i) {
        p[i] = positions[triangles[ids[lane]].vertex(i)];
        box = merge(box, p[i]);
      }
      if (is_degenerate(p[0], p[1], p[2])) p[1] = p[2] = p[0];
    }
    for (int i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis) block->vertex[i][axis][lane] = p[i][axis];
  }
  return box;
}

void bvh_refit(Accel* accel, Array<std::uint8_t> data) {
  BvhWritableView bvh(data.data);
  CHECK_EQ(bvh.header->triangle_count, accel->triangles.count);
  // Children come after their parents: from the last node to the first, every child is done before it is needed.
  for (std::uint32_t i = bvh.header->node_count; i-- > 0;) {
    BvhNode& node = bvh.nodes[i];
    for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
      std::uint32_t child = node.child[lane];
      if (child & kLeafBit) {
        TriangleBlock& block = bvh.leaves[child & kLeafIndexMask];
        std::uint32_t ids[kBvhLeafSize] = {block.triangle[0], block.triangle[1], block.triangle[2], block.triangle[3]};
        set_child_box(&node, lane,
                      gather_leaf(accel->positions, accel->triangles, ids, leaf_triangle_count(child), &block));
      } else {
        set_child_box(&node, lane, node_box(bvh.nodes[child]));
      }
    }
  }
  accel->data = data;
  accel->bounds = node_box(bvh.nodes[0]);
}

}  // namespace pocketray
