// The bounding volume hierarchy: nodes of four children whose bounds lie side by side in the node, and leaves of four
// triangles. Its data is one little-endian block without pointers, used directly from a file:
//
//   BvhHeader | BvhNode[node_count] | leaves[leaf_count]
//
// There are two kinds of leaves: those of `bvh` hold the vertices of their triangles (TriangleBlock), those of
// `compact` only triangle ids (CompactLeaf), so that a ray has to fetch the vertices from the mesh. Both have the same
// nodes.
//
// Numbering: node 0 is the root. Nodes are visited depth-first, last child first; a visited node assigns the next free
// node numbers to its inner children and the next free leaf numbers to its leaves. So siblings are adjacent, parents
// come before their children, and one walk can prove that the bytes form a tree.
#pragma once
#include "accel/accel.h"
#include "accel/triangle.h"

namespace pocketray {

// A child reference: the index of a node; or bit 31, the number of triangles less one (bits 29–30) and the index of a
// leaf.
constexpr std::uint32_t kLeafBit = 1u << 31;
constexpr std::uint32_t kLeafIndexMask = (1u << 29) - 1;
constexpr std::uint32_t kNoChild = 0xFFFFFFFFu;  // empty lane
constexpr std::uint32_t kBvhLeafSize = 4;
static_assert(kTriangleCountMax < kLeafIndexMask, "kNoChild is not a leaf");

constexpr std::uint32_t leaf_reference(std::uint32_t index, std::uint32_t triangle_count) {
  return kLeafBit | (triangle_count - 1) << 29 | index;
}
constexpr std::uint32_t leaf_triangle_count(std::uint32_t reference) { return ((reference >> 29) & 3) + 1; }

// Size of a traversal stack: at each level at most three siblings wait while the fourth is visited.
constexpr int kBvhStackSize = 3 * kBvhDepthMax + 4;

struct alignas(64) BvhHeader {
  std::uint32_t magic, triangle_count, node_count, leaf_count;
  std::uint32_t reserved[12];  // 0
};
static_assert(sizeof(BvhHeader) == 64, "nodes start on a cache line");
constexpr std::uint32_t kBvhMagic = 0x34485642;      // "BVH4"
constexpr std::uint32_t kCompactMagic = 0x34435642;  // "BVC4"

struct alignas(64) BvhNode {
  float bounds[6][4];         // low x, y, z, then high x, y, z, of the four children
  std::uint32_t child[4];     // children in use come first
  std::uint32_t still;        // bit i: refits leave child i as it is; 0 in files
  std::uint32_t reserved[3];  // 0
};
static_assert(sizeof(BvhNode) == 128, "two cache lines");

// Four triangle ids, with kUnhittableBit where no ray can hit the triangle. Unused lanes repeat the first triangle.
struct alignas(16) CompactLeaf {
  std::uint32_t triangle[4];
};
constexpr std::uint32_t kUnhittableBit = 1u << 31;
static_assert(kTriangleCountMax <= kUnhittableBit, "fits beside every id");

// One kind of leaves, for code that is not time-critical.
struct LeafKind {
  std::uint32_t magic;       // of the header
  std::uint32_t bytes;       // size of a leaf
  std::uint32_t ids_offset;  // offset in a leaf of its four ids, possibly with kUnhittableBit
  // Fills a leaf with triangles ids[0 .. count) and returns their bounds. Unhittable triangles are kept and marked:
  // they may become valid in a refit.
  Box (*fill)(Array<const Vec3> positions, Array<const Triangle> triangles, const std::uint32_t* ids,
              std::uint32_t count, void* leaf);
};
extern const LeafKind kBlockLeaves, kCompactLeaves;

// Typed views of the data; for `compact` only header and nodes.
template <class Byte, class Header, class Node, class Block>
struct BvhParts {
  Header* header;
  Node* nodes;
  Block* leaves;
  explicit BvhParts(Byte* data)
      : header(reinterpret_cast<Header*>(data)),
        nodes(reinterpret_cast<Node*>(data + sizeof(BvhHeader))),
        leaves(reinterpret_cast<Block*>(data + sizeof(BvhHeader) + sizeof(BvhNode) * std::size_t(header->node_count))) {
  }
};
using BvhView = BvhParts<const std::uint8_t, const BvhHeader, const BvhNode, const TriangleBlock>;
using BvhWritableView = BvhParts<std::uint8_t, BvhHeader, BvhNode, TriangleBlock>;

// 64 bits, so that no counts in a hostile file wrap around.
constexpr std::uint64_t bvh_bytes(std::uint64_t node_count, std::uint64_t leaf_count,
                                  std::uint64_t leaf_bytes = sizeof(TriangleBlock)) {
  return sizeof(BvhHeader) + sizeof(BvhNode) * node_count + leaf_bytes * leaf_count;
}
// Returns a leaf of a hierarchy of this kind.
inline const std::uint8_t* leaf_at(const LeafKind& kind, const std::uint8_t* data, std::size_t index) {
  std::size_t node_count = reinterpret_cast<const BvhHeader*>(data)->node_count;
  return data + bvh_bytes(node_count, index, kind.bytes);
}
inline const std::uint32_t* leaf_ids(const LeafKind& kind, const std::uint8_t* leaf) {
  return reinterpret_cast<const std::uint32_t*>(leaf + kind.ids_offset);
}

inline Box child_box(const BvhNode& node, int lane) {
  return {{node.bounds[0][lane], node.bounds[1][lane], node.bounds[2][lane]},
          {node.bounds[3][lane], node.bounds[4][lane], node.bounds[5][lane]}};
}
inline void set_child_box(BvhNode* node, int lane, const Box& box) {
  for (int axis = 0; axis < 3; ++axis)
    node->bounds[axis][lane] = box.low[axis], node->bounds[3 + axis][lane] = box.high[axis];
}
// The box of an empty lane, which no ray enters: inverted, but finite, so that differences of its planes are not NaN.
inline Box no_child_box() {
  constexpr float far = 16 * kCoordinateMax;
  return {{far, far, far}, {-far, -far, -far}};
}
inline Box node_box(const BvhNode& node) {
  return merge(merge(child_box(node, 0), child_box(node, 1)), merge(child_box(node, 2), child_box(node, 3)));
}

// AccelInfo's functions for either kind.
std::size_t bvh_need(const LeafKind& kind, std::uint32_t triangle_count);
std::size_t bvh_scratch_need(std::uint32_t triangle_count);
void bvh_build(const LeafKind& kind, Accel* accel, Arena* keep, Arena* scratch);
void bvh_settle(const LeafKind& kind, Accel* accel, Array<std::uint8_t> data, Array<const MovingMesh> moving);
void bvh_refit(const LeafKind& kind, Accel* accel, Array<std::uint8_t> data);
Status bvh_adopt(const LeafKind& kind, Accel* accel, Array<const std::uint8_t> data, const ParallelLoop& loop);
float bvh_largest(const LeafKind& kind, const Accel& accel, const TriangleQuery& query);

}  // namespace pocketray
