// The surfaces of a tile that receive light, for tile_shadows.cpp and tile_lamps.cpp.
#pragma once
#include "base/fmath.h"
#include "shade/clear_coat.h"
#include "shade/filters.h"
#include "shade/lights.h"
#include "shade/tile_shadows.h"
#include "shade/tracer.h"

namespace pocketray {

inline bool receives(const FrameData& frame, const Surface& s) {
  return !(is_zero(s.diffuse) && is_zero(s.material->specular)) || shines_by_coat(frame, s);
}

// True if direct_light() will probably skip light of that irradiance, or the ray to a sample; ignores
// highlights.
[[gnu::always_inline]] inline bool cannot_matter(const FrameData& frame, const Surface& s, const Vec3& irradiance) {
  if (!is_zero(s.material->specular)) return false;
  return max_component(s.diffuse * (1 / kPiF) * irradiance) <= frame.cut_off.left_out_max && !shines_by_coat(frame, s);
}
[[gnu::always_inline]] inline bool cannot_matter(const FrameData& frame, const Surface& s, const LightSample& sample) {
  if (!is_zero(s.material->specular)) return false;
  Vec3 most = s.diffuse * (1 / kPiF) * sample.irradiance * dot(s.normal, sample.direction);
  return max_component(most) <= frame.cut_off.left_out_max && !shines_by_coat(frame, s);
}

void find_receivers(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                    TileReceivers* receivers);

// Returns which rays to an area light (or, with null, to another light) something opaque blocks: bit i for ray i.
std::uint64_t trace_packet(Tracer* tracer, const SegmentPacket& packet, const LightPoint* emitter);

// Pixels with a known view of a light: those that it surely lights (lit), does not light (unlit), and those of the
// former to which it matters.
struct KnownViews {
  TileMask lit, unlit, matter;
};

// Traces the shadow rays to light point i, in the run. Inline, because most lights have no known views.
[[gnu::always_inline]] inline void trace_light(Tracer* tracer, const LightRun& run, std::uint32_t i,
                                               const TileReceivers& receivers, const KnownViews* views,
                                               TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  const LightPoint& light = tracer->light_points[i];
  const bool keeps_sample = i < kTileSampleMax;
  TileMask lit = {}, traced = {}, hidden = {};
  std::uint8_t pixel[kPacketMax];
  SegmentPacket packet;
  packet.count = 0;
  for (std::uint32_t k = 0; k < receivers.count; ++k) {
    const std::uint32_t place = receivers.pixel[k];
    const Surface& s = shadows->surface[place];
    LightSample sample;
    if (views && views->lit[place]) {
      if (!views->matter[place]) continue;
      sample.to_light = light.position - s.point, sample.t_max = 1;
    } else {
      if ((views && views->unlit[place]) || !lights_up(frame, s, run, light, &sample)) continue;
      lit.set(place);
      if (keeps_sample) shadows->sample[i][place] = {sample.direction, sample.irradiance};
      if (!(dot(s.geometric, sample.direction) > 0)) continue;
      if (cannot_matter(frame, s, sample)) continue;
    }
    traced.set(place);
    pixel[packet.count] = receivers.pixel[k];
    set_ray(&packet, packet.count++, {receivers.origin[place], sample.to_light, sample.t_max, s.hit.triangle});
  }
  if (packet.count > 0)
    for (std::uint64_t blocked = trace_packet(tracer, packet, emitter_of(light)); blocked; blocked &= blocked - 1)
      hidden.set(pixel[__builtin_ctzll(blocked)]);
  shadows->lit[i] = lit, shadows->traced[i] = traced, shadows->blocked[i] = hidden;
}

}  // namespace pocketray
