// Lines of flat surfaces across which their light changes at once: the feet of partitions that stand on them, and the
// outlines of sheets close above them, such as a lamp below a ceiling.
#pragma once
#include "desktop/radiosity/cuts.h"

namespace pocketray {

struct Barrier {
  Vec3d a, b;    // in the surface's plane
  Vec3d inward;  // in that plane, unit, across the barrier: where the sheet lies
  double gap;    // its largest distance from the plane
};

// Finds those of a surface's front or back. Sheets whose backs let views through are none, seen from behind.
std::vector<Barrier> find_barriers(const Scene& scene, const Surfaces& surfaces, const FlatSurface& flat,
                                   const std::vector<CutEdge>& edges, bool back);

}  // namespace pocketray
