// Shadow rays of a tile, tested against the moving geometry and against everything else.
#pragma once
#include "accel/accel_list.h"
#include "shade/filters.h"
#include "temporal/tile_search.h"

namespace pocketray {

// The filter of some shadow rays, for triangles of the moving geometry, and for all others of the scene.
struct ShadowFilters {
  const MovingGeometry& geometry;
  HitFilter inner;
  HitFilter moving, other;
  ShadowFilters(const MovingGeometry& geometry_, const HitFilter& inner_);
  ShadowFilters(const ShadowFilters&) = delete;  // the filters point to it
  ShadowFilters& operator=(const ShadowFilters&) = delete;
};

struct ShadowRays {
  SegmentPacket rays;
  std::uint64_t pixel[kPacketMax];  // of each, as a bit of the tile
};
// Which of the rays `which` something blocks; bit i is ray i.
std::uint64_t blocked_among(const AccelTraversal& traversal, const Accel& accel, const ShadowRays& s,
                            std::uint64_t which, const HitFilter* filter, TraceStats* stats);

}  // namespace pocketray
