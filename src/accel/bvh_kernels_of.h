// The kernel table of one compilation for one kind of hierarchy. See bvh_kernels.h.
#pragma once
#include "accel/bvh_kernels.h"
#include "accel/bvh_packet_entry.h"
#include "accel/bvh_shaft.h"
#include "accel/bvh_single.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

// Tree: BlockTree or CompactTree.
template <class Tree, int kLanes>
constexpr AccelTraversal kernels_of() {
  return {closest<Tree>, closest_packet<Tree, kLanes>, occluded<Tree>, occluded_packet<Tree, kLanes>};
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
