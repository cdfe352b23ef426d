// Packets for accelerators without packet traversal: one ray after the other.
#pragma once
#include "accel/accel.h"
#include "accel/packet.h"

namespace pocketray {

template <decltype(AccelInfo::closest) closest>
void closest_by_rays(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits, TraceStats* stats) {
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    Vec3 direction = {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]};
    closest(accel, {rays.origin, direction, rays.t_max}, filter, &hits[i], stats);
  }
}

template <decltype(AccelInfo::occluded) occluded>
std::uint64_t occluded_by_rays(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                               TraceStats* stats) {
  std::uint64_t blocked = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i)
    blocked |= static_cast<std::uint64_t>(occluded(accel, ray_of(rays, i), filter, stats)) << i;
  return blocked;
}

}  // namespace pocketray
