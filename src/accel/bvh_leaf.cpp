// The two kinds of leaves.
#include "accel/bvh.h"

namespace pocketray {
namespace {

// Fetches the vertices of a triangle; returns whether a ray can hit it. Invalid triangles are moved to the origin;
// valid ones are added to the box.
bool fetch_triangle(Array<const Vec3> positions, const Triangle& triangle, Vec3 p[3], Box* box) {
  bool valid = has_valid_vertices(positions, triangle);
  for (std::uint32_t i = 0; i < 3; ++i) {
    p[i] = valid ? positions[triangle.vertex(i)] : Vec3{0, 0, 0};
    if (valid) *box = merge(*box, p[i]);
  }
  return valid && !is_degenerate(p[0], p[1], p[2]);
}

// Unused lanes and unhittable triangles become points, which no ray hits.
Box fill_block(Array<const Vec3> positions, Array<const Triangle> triangles, const std::uint32_t* ids,
               std::uint32_t count, void* leaf) {
  TriangleBlock* block = static_cast<TriangleBlock*>(leaf);
  Box box = empty_box();
  for (std::uint32_t lane = 0; lane < kBvhLeafSize; ++lane) {
    Vec3 p[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    block->triangle[lane] = lane < count ? ids[lane] : kNoTriangle;
    if (lane < count && !fetch_triangle(positions, triangles[ids[lane]], p, &box)) p[1] = p[2] = p[0];
    for (int i = 0; i < 3; ++i)
      for (int axis = 0; axis < 3; ++axis) block->vertex[i][axis][lane] = p[i][axis];
  }
  return box;
}

Box fill_compact(Array<const Vec3> positions, Array<const Triangle> triangles, const std::uint32_t* ids,
                 std::uint32_t count, void* leaf) {
  std::uint32_t* words = static_cast<CompactLeaf*>(leaf)->triangle;
  Box box = empty_box();
  for (std::uint32_t lane = 0; lane < kBvhLeafSize; ++lane) {
    Vec3 p[3];
    if (lane >= count)
      words[lane] = words[0];
    else
      words[lane] = ids[lane] | (fetch_triangle(positions, triangles[ids[lane]], p, &box) ? 0 : kUnhittableBit);
  }
  return box;
}

}  // namespace

const LeafKind kBlockLeaves = {kBvhMagic, sizeof(TriangleBlock), offsetof(TriangleBlock, triangle), fill_block};
const LeafKind kCompactLeaves = {kCompactMagic, sizeof(CompactLeaf), offsetof(CompactLeaf, triangle), fill_compact};

}  // namespace pocketray
