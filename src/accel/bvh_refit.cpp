// Adapts a BVH in place to vertices that have moved.
#include <algorithm>
#include <limits>

#include "accel/bvh.h"
#include "accel/denormals.h"
#include "base/check.h"
#include "scene/moving.h"

namespace pocketray {
namespace {

BvhWritableView view_of(const LeafKind& kind, const Accel& accel, Array<std::uint8_t> data) {
  CHECK_LE(bvh_bytes(1, 0), data.bytes());
  CHECK_EQ(reinterpret_cast<std::uintptr_t>(data.data) % alignof(BvhNode), 0u);
  BvhWritableView bvh(data.data);
  CHECK_EQ(bvh.header->triangle_count, accel.triangles.count);
  CHECK_EQ(bvh.header->magic, kind.magic);
  CHECK_EQ(data.bytes(), bvh_bytes(bvh.header->node_count, bvh.header->leaf_count, kind.bytes));
  return bvh;
}

std::uint32_t list_triangles(const LeafKind& kind, const std::uint8_t* leaf, std::uint32_t reference,
                             std::uint32_t (&ids)[kBvhLeafSize]) {
  const std::uint32_t count = leaf_triangle_count(reference);
  for (std::uint32_t k = 0; k < count; ++k) ids[k] = leaf_ids(kind, leaf)[k] & ~kUnhittableBit;
  return count;
}

bool is_still(const BvhNode& node) {
  std::uint32_t all = 0;
  for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) all |= 1u << lane;
  return node.still == all;
}

struct Refit {
  const LeafKind& kind;
  const Accel& accel;
  BvhNode* nodes;
  std::uint8_t* leaves;
};

// Recurses at most kBvhDepthMax times.
void refit_node(const Refit& r, BvhNode* node) {
  for (int lane = 0; lane < 4 && node->child[lane] != kNoChild; ++lane) {
    const std::uint32_t child = node->child[lane];
    if (node->still >> lane & 1) continue;
    if (child & kLeafBit) {
      std::uint8_t* leaf = r.leaves + std::size_t(r.kind.bytes) * (child & kLeafIndexMask);
      std::uint32_t ids[kBvhLeafSize];
      const std::uint32_t count = list_triangles(r.kind, leaf, child, ids);
      set_child_box(node, lane, r.kind.fill(r.accel.positions, r.accel.triangles, ids, count, leaf));
    } else {
      refit_node(r, &r.nodes[child]);
      set_child_box(node, lane, node_box(r.nodes[child]));
    }
  }
}

// Smallest nonzero magnitude of a coordinate over the vertices that can move or, with `still`, over all others.
float least_coordinate_of(const Accel& accel, bool still) {
  float least = std::numeric_limits<float>::infinity();
  std::uint32_t from = 0;
  auto look = [&](std::uint32_t begin, std::uint32_t end) {
    least = std::min(least, least_coordinate({accel.positions.data + begin, end - begin}));
  };
  for (const MovingMesh& run : accel.moving) {
    still ? look(from, run.vertex_begin) : look(run.vertex_begin, run.vertex_begin + run.vertex_count);
    from = run.vertex_begin + run.vertex_count;
  }
  if (still) look(from, static_cast<std::uint32_t>(accel.positions.count));
  return least;
}

}  // namespace

void bvh_settle(const LeafKind& kind, Accel* accel, Array<std::uint8_t> data, Array<const MovingMesh> moving) {
  BvhWritableView bvh = view_of(kind, *accel, data);
  accel->moving = moving;
  accel->least_still = least_coordinate_of(*accel, true);
  // Children come after their parents: from the last node to the first, every child is marked before its parent.
  for (std::uint32_t i = bvh.header->node_count; i-- > 0;) {
    BvhNode& node = bvh.nodes[i];
    node.still = 0;
    for (int lane = 0; lane < 4 && node.child[lane] != kNoChild; ++lane) {
      const std::uint32_t child = node.child[lane];
      bool still = true;
      if (child & kLeafBit) {
        std::uint32_t ids[kBvhLeafSize];
        const std::uint32_t count = list_triangles(kind, leaf_at(kind, data.data, child & kLeafIndexMask), child, ids);
        for (std::uint32_t k = 0; k < count; ++k) still = still && !moves(moving, accel->triangles[ids[k]]);
      } else {
        still = is_still(bvh.nodes[child]);
      }
      node.still |= std::uint32_t(still) << lane;
    }
  }
}

void bvh_refit(const LeafKind& kind, Accel* accel, Array<std::uint8_t> data) {
  BvhWritableView bvh = view_of(kind, *accel, data);
  refit_node({kind, *accel, bvh.nodes, data.data + bvh_bytes(bvh.header->node_count, 0)}, &bvh.nodes[0]);
  accel->data = data;
  accel->bounds = node_box(bvh.nodes[0]);
  accel->least_coordinate = accel->moving.empty() ? least_coordinate(accel->positions)
                                                  : std::min(accel->least_still, least_coordinate_of(*accel, false));
}

}  // namespace pocketray
