// Quick checks of a BVH from a file. They may fail for sound data, which bvh_adopt.cpp then checks slowly, but pass
// only if it is sound.
#pragma once
#include "accel/bvh.h"

namespace pocketray {

struct CheckedTree {
  const LeafKind& kind;
  const BvhNode* nodes;
  const std::uint8_t* leaves;
  Array<const Vec3> positions;
  Array<const Triangle> triangles;
};

// Returns whether every vertex index is in range and every coordinate within kCoordinateMax.
bool has_only_valid_triangles(Array<const Vec3> positions, Array<const Triangle> triangles);

// Returns true only if the boxes of a node's children are exact and its leaves hold the scene's triangles, as fill()
// would have filled them. Inner children count as their boxes say, which remain to be checked. The tree's triangles are
// all valid, and the indices of children are in range; ids in leaves may be anything.
bool is_plainly_sound(const CheckedTree& tree, const BvhNode& node);

}  // namespace pocketray
