// The trees that kernels traverse: the nodes and leaves of either kind of hierarchy. Part of the kernels: see
// bvh_kernels.h.
#pragma once
#include "accel/bvh.h"
#include "base/simd.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

inline void prefetch_node(const BvhNode& node) {
  const char* first = reinterpret_cast<const char*>(&node);
  __builtin_prefetch(first), __builtin_prefetch(first + 64);
}

// `bvh`.
struct BlockTree {
  const BvhNode* nodes;
  const TriangleBlock* leaves;
  explicit BlockTree(const Accel& accel) {
    BvhView bvh(accel.data.data);
    nodes = bvh.nodes, leaves = bvh.leaves;
  }
  // Returns the triangles of a leaf child, in `scratch` unless the leaf holds them.
  const TriangleBlock& leaf(std::uint32_t child, TriangleBlock*) const { return leaves[child & kLeafIndexMask]; }
  // Prefetches a child.
  void prefetch(std::uint32_t child) const {
    if (!(child & kLeafBit)) return prefetch_node(nodes[child]);
    const char* first = reinterpret_cast<const char*>(&leaves[child & kLeafIndexMask]);
    __builtin_prefetch(first), __builtin_prefetch(first + 64), __builtin_prefetch(first + 128);
  }
};

// Sets the ids, and replaces unhittable triangles, whose vertices may not exist in the mesh, by points, which no ray
// hits.
__attribute__((noinline)) inline void gather_hittable(const Vec3* positions, const Triangle* triangles,
                                                      const CompactLeaf& leaf, TriangleBlock* block) {
  for (int lane = 0; lane < 4; ++lane) {
    std::uint32_t word = leaf.triangle[lane];
    block->triangle[lane] = word & ~kUnhittableBit;  // filters may be asked before the full test
    for (int i = 0; i < 3; ++i) {
      Vec3 p = {0, 0, 0};
      if (!(word & kUnhittableBit)) p = positions[triangles[word].vertex(static_cast<std::uint32_t>(i))];
      for (int axis = 0; axis < 3; ++axis) block->vertex[i][axis][lane] = p[axis];
    }
  }
}

// Fetches the vertices of a leaf from the mesh.
inline const TriangleBlock& gather_leaf(const Vec3* positions, const Triangle* triangles, const CompactLeaf& leaf,
                                        TriangleBlock* block) {
  const std::uint32_t* id = leaf.triangle;
  for (int lane = 0; lane < 4; ++lane) block->triangle[lane] = id[lane];
  if (__builtin_expect((id[0] | id[1] | id[2] | id[3]) & kUnhittableBit, 0)) {
    gather_hittable(positions, triangles, leaf, block);
    return *block;
  }
  const Triangle &a = triangles[id[0]], &b = triangles[id[1]], &c = triangles[id[2]], &d = triangles[id[3]];
  for (std::uint32_t i = 0; i < 3; ++i) {
    const float* const points[4] = {&positions[a.vertex(i)].x, &positions[b.vertex(i)].x, &positions[c.vertex(i)].x,
                                    &positions[d.vertex(i)].x};
    Float4 rows[3];
    load_points(points, rows);
    for (int axis = 0; axis < 3; ++axis) store(block->vertex[i][axis], rows[axis]);
  }
  return *block;
}

// `compact`.
struct CompactTree {
  const BvhNode* nodes;
  const CompactLeaf* leaves;
  const Vec3* positions;
  const Triangle* triangles;
  explicit CompactTree(const Accel& accel) : positions(accel.positions.data), triangles(accel.triangles.data) {
    nodes = BvhView(accel.data.data).nodes;
    leaves = reinterpret_cast<const CompactLeaf*>(leaf_at(kCompactLeaves, accel.data.data, 0));
  }
  const TriangleBlock& leaf(std::uint32_t child, TriangleBlock* scratch) const {
    return gather_leaf(positions, triangles, leaves[child & kLeafIndexMask], scratch);
  }
  void prefetch(std::uint32_t child) const {
    if (!(child & kLeafBit)) return prefetch_node(nodes[child]);
    __builtin_prefetch(&leaves[child & kLeafIndexMask]);
  }
};

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
