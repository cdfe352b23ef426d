// Shadow rays of a tile, tested against the moving geometry and against everything else.
#pragma once
#include "accel/accel_list.h"
#include "shade/filters.h"
#include "temporal/tile_search.h"

namespace pocketray {

// Filters of shadow rays for triangles of the moving geometry, and for all other triangles of the scene.
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
  std::uint64_t pixel[kPacketMax];  // by ray, as a bit of the tile
};
// Masks of the rays among `which` that something blocks, in the scene or in an accelerator of the moving geometry; bit
// i is ray i.
std::uint64_t blocked_by_scene(const FrameData& frame, const ShadowRays& s, std::uint64_t which,
                               const HitFilter* filter, TraceStats* stats);
std::uint64_t blocked_by_moving(const Accel& moving, const ShadowRays& s, std::uint64_t which, const HitFilter* filter,
                                TraceStats* stats);

}  // namespace pocketray
