// Searches the moving geometry for changed triangles that a beam may meet. Compiled for each instruction set
// (base/isa.h).
#pragma once
#include "accel/bvh.h"
#include "base/check.h"
#include "base/soft_float.h"
#include "temporal/moving_geometry.h"
#include "temporal/triangle_beam.h"

namespace pocketray {

#if defined(POCKETRAY_HAVE_NEON32)
// The beam must be tame.
bool meets_change_neon(const MovingGeometry& moving, const BoundedBeam& beam);
#endif

inline namespace POCKETRAY_ISA {

// Mask of a leaf's triangles that have changed.
inline unsigned changed_lanes(const MovingGeometry& m, const TriangleBlock& leaf, std::uint32_t count) {
  unsigned changed = 0;
  for (std::uint32_t k = 0; k < count; ++k)
    changed |= static_cast<unsigned>(m.triangle_changed[leaf.triangle[k] & ~kUnhittableBit] != 0) << k;
  return changed;
}

// Without an FPU, rays against triangles in integers cost less than planes between them.
#if defined(POCKETRAY_HAS_NO_FPU)
constexpr bool kTestsTriangles = false;
#else
constexpr bool kTestsTriangles = true;
#endif

inline bool meets_change(const MovingGeometry& m, const BoundedBeam& beam) {
  BvhView last(m.last.data.data), now(m.now.data.data);
  BeamHull hull;
  bool has_hull = false;
  std::uint32_t stack[kBvhStackSize];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t i = stack[--top];
    unsigned met = m.node_changed[i];
    if (met) met &= meets_both(beam.tested, now.nodes[i].bounds, last.nodes[i].bounds);
    for (; met; met &= met - 1) {
      const std::uint32_t child = now.nodes[i].child[__builtin_ctz(met)];
      if (child & kLeafBit) {
        if (!kTestsTriangles) return true;
        if (!has_hull) hull = make_beam_hull(beam), has_hull = true;
        const TriangleBlock &is = now.leaves[child & kLeafIndexMask], &was = last.leaves[child & kLeafIndexMask];
        const unsigned changed = changed_lanes(m, is, leaf_triangle_count(child));
        if (may_meet(hull, is, changed) || may_meet(hull, was, changed)) return true;
        continue;
      }
      CHECK_LT(top, kBvhStackSize);
      stack[top++] = child;
    }
  }
  return false;
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
