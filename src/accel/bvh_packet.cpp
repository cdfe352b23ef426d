#define POCKETRAY_ISA baseline
#include "accel/bvh_packet_entry.h"

namespace pocketray {

void bvh_closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits,
                        TraceStats* stats) {
  baseline::closest_packet<4>(accel, rays, filter, hits, stats);
}

}  // namespace pocketray
