// The shadow rays of interleaved sources.
#pragma once
#include "base/check.h"
#include "shade/filters.h"
#include "shade/interleaved.h"

namespace pocketray {

// Source: count, those close to each other in sequence, and arrives(index, surface, origin, &light, &ray): false if the
// surface is turned away from it.
template <class Source>
void gather_interleaved(const FrameData& frame, const InterleavedPoints& points, const Source& source,
                        bool casts_shadows, TraceStats* stats, std::uint64_t* rays, InterleavedLight* light) {
  CHECK_LE(points.count, kPacketMax);
  Vec3 origin[kPacketMax], sent[kPacketMax];
  std::uint8_t sender[kPacketMax];
  for (std::uint32_t i = 0; i < points.count; ++i)
    light[i] = InterleavedLight(), origin[i] = safe_origin(*points.surface[i], 1);
  ShadowContext context = {&frame, kNone};
  HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
  SegmentPacket packet;
  for (std::uint32_t first = 0; first < source.count; first += kPatternPixels) {
    packet.count = 0;
    for (std::uint32_t i = 0; i < points.count; ++i) {
      const std::uint32_t index = first + points.place[i];
      Ray ray;
      if (is_zero(points.surface[i]->diffuse) || index >= source.count) continue;
      if (!source.arrives(index, *points.surface[i], origin[i], &sent[packet.count], &ray)) continue;
      light[i].open += sent[packet.count];
      sender[packet.count] = static_cast<std::uint8_t>(i);
      set_ray(&packet, packet.count++, ray);
    }
    *rays += packet.count;
    std::uint64_t blocked = 0;
    if (packet.count > 0 && casts_shadows)
      blocked =
          frame.first_rays->occluded_packet(frame.accel, packet, frame.filter_every_shadow ? &opaque : nullptr, stats);
    for (std::uint32_t k = 0; k < packet.count; ++k)
      if (!(blocked >> k & 1)) light[sender[k]].lit += sent[k];
  }
}

}  // namespace pocketray
