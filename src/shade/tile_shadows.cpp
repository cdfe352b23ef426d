#include "shade/tile_shadows.h"

#include "base/fmath.h"
#include "shade/filters.h"
#include "shade/lights.h"

namespace pocketray {
namespace {

bool receives(const Surface& s) { return !(is_zero(s.diffuse) && is_zero(s.material->specular)); }

// Whether direct_light() will probably skip the ray; highlights are not estimated.
bool cannot_matter(const FrameData& frame, const Surface& s, const LightSample& sample) {
  if (!is_zero(s.material->specular)) return false;
  Vec3 most = s.diffuse * (1 / kPiF) * sample.irradiance * dot(s.normal, sample.direction);
  return max_component(most) <= frame.left_out_max;
}

// The pixels whose first hits receive light.
std::uint32_t find_receivers(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                             std::uint8_t* receivers, Vec3* origins) {
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    if (hits[i].triangle == kNoTriangle) continue;
    Surface& s = shadows->surface[i];
    frame.first_surface(frame, ray_of(rays, i), hits[i], &s);
    origins[i] = safe_origin(s, 1);
    if (receives(s)) receivers[count++] = static_cast<std::uint8_t>(i);
  }
  return count;
}

}  // namespace

void find_tile_shadows(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                       TraceStats* stats) {
  std::uint8_t receivers[kPacketMax], pixel[kPacketMax];
  Vec3 origins[kPacketMax];  // of the shadow rays, by pixel
  std::uint32_t receiver_count = find_receivers(frame, rays, hits, shadows, receivers, origins);
  SegmentPacket packet;
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    for (std::uint32_t i = run.begin; i < run.end && i < kTileLightMax; ++i) {
      const LightPoint& light = frame.lights[i];
      const bool keeps_sample = i < kTileSampleMax;
      TileMask lit = {}, traced = {}, hidden = {};
      packet.count = 0;
      for (std::uint32_t k = 0; k < receiver_count; ++k) {
        const std::uint32_t place = receivers[k];
        const Surface& s = shadows->surface[place];
        LightSample sample;
        if (!lights_up(frame, s, run, light, &sample)) continue;
        lit.set(place);
        if (keeps_sample) shadows->sample[i][place] = {sample.direction, sample.irradiance};
        if (!(dot(s.geometric, sample.direction) > 0)) continue;
        if (cannot_matter(frame, s, sample)) continue;
        traced.set(place);
        pixel[packet.count] = receivers[k];
        set_ray(&packet, packet.count++, {origins[place], sample.to_light, sample.t_max});
      }
      if (packet.count > 0) {
        ShadowContext context = {&frame, light.material};
        HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
        bool filtered = frame.filter_every_shadow || light.material != kNone;
        std::uint64_t blocked =
            frame.first_rays->occluded_packet(frame.accel, packet, filtered ? &opaque : nullptr, stats);
        for (; blocked; blocked &= blocked - 1) hidden.set(pixel[__builtin_ctzll(blocked)]);
      }
      shadows->lit[i] = lit, shadows->traced[i] = traced, shadows->blocked[i] = hidden;
    }
  }
}

}  // namespace pocketray
