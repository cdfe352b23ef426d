// Shadow rays of a tile's first hits, traced in packets before shading needs them.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr std::uint32_t kTileLightMax = 64;  // further lights are tested ray by ray

// For each pixel of a tile the surface at its first hit, if any. For each light, which of the pixels' shadow rays were
// traced and which of these are blocked by something opaque: bit i for pixel i.
struct TileShadows {
  Surface surface[kPacketMax];
  std::uint64_t traced[kTileLightMax], blocked[kTileLightMax];
};

// Fills `shadows` for the rays of a packet and their first hits.
void find_tile_shadows(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                       TraceStats* stats);

// Whether the result of a shadow ray from the first hit is known, and the result. (The packet holds no ray that starts
// below the surface.)
inline bool is_known(const Tracer& tracer, std::uint32_t light, bool* blocked) {
  if (!tracer.tile_shadows || light >= kTileLightMax) return false;
  if (!(tracer.tile_shadows->traced[light] >> tracer.tile_pixel & 1)) return false;
  *blocked = tracer.tile_shadows->blocked[light] >> tracer.tile_pixel & 1;
  return true;
}

}  // namespace pocketray
