#include "shade/tile_shadows.h"

#include "shade/tile_receivers.h"

namespace pocketray {

void find_receivers(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                    TileReceivers* receivers) {
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    if (hits[i].triangle == kNoTriangle) continue;
    Surface& s = shadows->surface[i];
    frame.kernels.surface(frame, ray_of(rays, i), hits[i], &s);
    receivers->origin[i] = safe_origin(s, 1);
    if (receives(frame, s)) receivers->pixel[receivers->count++] = static_cast<std::uint8_t>(i);
  }
}

std::uint64_t trace_packet(Tracer* tracer, const SegmentPacket& packet, const LightPoint* emitter) {
  const FrameData& frame = *tracer->frame;
  ShadowContext context = {&frame, emitter};
  HitFilter opaque = {frame.filters.accept_opaque, &context, frame.filters.read_point};
  bool filtered = frame.filters.every_shadow || emitter != nullptr;
  return frame.geometry.first_rays->occluded_packet(frame.geometry.accel, packet, filtered ? &opaque : nullptr,
                                                    &tracer->stats);
}

void find_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  TileReceivers receivers;
  find_receivers(frame, rays, hits, shadows, &receivers);
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    for (std::uint32_t i = run.begin; i < run.end && i < kTileLightMax; ++i)
      trace_light(tracer, run, i, receivers, nullptr, shadows);
  }
}

}  // namespace pocketray
