// Shadow rays of a tile's first hits, traced in packets before shading asks about them.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr std::uint32_t kTileLightMax = 64;  // lights beyond are asked about ray by ray

// For each pixel of a tile the surface of its first hit, if any, and for each light which of the pixels' shadow rays
// were traced and which of them something opaque blocks: bit i for pixel i.
struct TileShadows {
  Surface surface[kPacketMax];
  Vec3 origin[kPacketMax];  // of the shadow rays
  std::uint64_t traced[kTileLightMax], blocked[kTileLightMax];
};

// Fills `shadows` for the rays of a packet and what they hit first.
void find_tile_shadows(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                       TraceStats* stats);

// Whether a shadow ray starts where the first hit of the tracer's pixel is: then its answer may be known.
inline bool starts_at_first_hit(const Tracer& tracer, const Vec3& point, const Vec3& origin) {
  const TileShadows* shadows = tracer.tile_shadows;
  return shadows && shadows->surface[tracer.tile_pixel].point == point && shadows->origin[tracer.tile_pixel] == origin;
}
// Whether it is known for a light, and what it is.
inline bool is_known(const Tracer& tracer, std::uint32_t light, bool* blocked) {
  if (light >= kTileLightMax || !(tracer.tile_shadows->traced[light] >> tracer.tile_pixel & 1)) return false;
  *blocked = tracer.tile_shadows->blocked[light] >> tracer.tile_pixel & 1;
  return true;
}

}  // namespace pocketray
