#include "shade/tile_shadows.h"

#include <algorithm>

#include "base/fmath.h"
#include "shade/filters.h"
#include "shade/lights.h"
#include "shade/point_groups.h"

namespace pocketray {
namespace {

bool receives(const Surface& s) { return !(is_zero(s.diffuse) && is_zero(s.material->specular)); }

// Whether direct_light() will probably skip the ray; highlights are not estimated.
[[gnu::always_inline]] inline bool cannot_matter(const FrameData& frame, const Surface& s, const LightSample& sample) {
  if (!is_zero(s.material->specular)) return false;
  Vec3 most = s.diffuse * (1 / kPiF) * sample.irradiance * dot(s.normal, sample.direction);
  return max_component(most) <= frame.left_out_max;
}

// The pixels whose first hits receive light, and the origins of their shadow rays, by pixel.
struct Receivers {
  std::uint32_t count = 0;
  std::uint8_t pixel[kPacketMax];
  Vec3 origin[kPacketMax];
};

void find_receivers(const FrameData& frame, const RayPacket& rays, const Hit* hits, TileShadows* shadows,
                    Receivers* receivers) {
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    if (hits[i].triangle == kNoTriangle) continue;
    Surface& s = shadows->surface[i];
    frame.first_surface(frame, ray_of(rays, i), hits[i], &s);
    receivers->origin[i] = safe_origin(s, 1);
    if (receives(s)) receivers->pixel[receivers->count++] = static_cast<std::uint8_t>(i);
  }
}

std::uint64_t trace_packet(Tracer* tracer, const SegmentPacket& packet, std::uint32_t emitter) {
  const FrameData& frame = *tracer->frame;
  ShadowContext context = {&frame, emitter};
  HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
  bool filtered = frame.filter_every_shadow || emitter != kNone;
  return frame.first_rays->occluded_packet(frame.accel, packet, filtered ? &opaque : nullptr, &tracer->stats);
}

void trace_light(Tracer* tracer, const LightRun& run, std::uint32_t i, const Receivers& receivers,
                 TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  const LightPoint& light = frame.lights[i];
  const bool keeps_sample = i < kTileSampleMax;
  TileMask lit = {}, traced = {}, hidden = {};
  std::uint8_t pixel[kPacketMax];
  SegmentPacket packet;
  packet.count = 0;
  for (std::uint32_t k = 0; k < receivers.count; ++k) {
    const std::uint32_t place = receivers.pixel[k];
    const Surface& s = shadows->surface[place];
    LightSample sample;
    if (!lights_up(frame, s, run, light, &sample)) continue;
    lit.set(place);
    if (keeps_sample) shadows->sample[i][place] = {sample.direction, sample.irradiance};
    if (!(dot(s.geometric, sample.direction) > 0)) continue;
    if (cannot_matter(frame, s, sample)) continue;
    traced.set(place);
    pixel[packet.count] = receivers.pixel[k];
    set_ray(&packet, packet.count++, {receivers.origin[place], sample.to_light, sample.t_max});
  }
  if (packet.count > 0)
    for (std::uint64_t blocked = trace_packet(tracer, packet, light.material); blocked; blocked &= blocked - 1)
      hidden.set(pixel[__builtin_ctzll(blocked)]);
  shadows->lit[i] = lit, shadows->traced[i] = traced, shadows->blocked[i] = hidden;
}

// The points of one area light as seen from a tile's first hits: what is_point_blocked() finds, for all at once. Pixels
// are bits.
class TilePoints {
 public:
  TilePoints(Tracer* tracer, const LightRun& run, std::uint32_t first, const Receivers& receivers, TileShadows* shadows)
      : tracer_(tracer), frame_(*tracer->frame), run_(run), first_(first), receivers_(receivers), shadows_(shadows) {
    const PointGroups& groups = frame_.point_groups;
    const std::uint32_t place = first - groups.first_point;
    groups_ = &groups.groups[place];
    order_ = &groups.order[place];
    packet_.count = 0;
  }

  // Of a light whose last points exceed kTileLightMax, only which pixels it lights up.
  void find() {
    const std::uint32_t all = frame_.point_groups.points_of_light, count = std::min(all, kTileLightMax - first_);
    std::uint64_t matter = 0;
    for (std::uint32_t point = 0; point < count; ++point) matter |= find_probes(point);
    if (count == all) test(groups_[0], matter);
    for (std::uint32_t point = 0; point < count; ++point) {
      TileMask decided = {}, hidden = {};
      for (std::uint64_t rest = known_[point] & matter; rest; rest &= rest - 1)
        decided.set(static_cast<std::uint32_t>(__builtin_ctzll(rest)));
      for (std::uint64_t rest = blocked_[point]; rest; rest &= rest - 1)
        hidden.set(static_cast<std::uint32_t>(__builtin_ctzll(rest)));
      shadows_->traced[first_ + point] = {};
      shadows_->decided[first_ + point] = decided, shadows_->blocked[first_ + point] = hidden;
    }
  }

 private:
  static constexpr int kTogetherMax = 12;  // pixels; their rays to all probes fill a packet

  // The pixels that it lights up, and those from which it is a probe; returns those to which it matters.
  std::uint64_t find_probes(std::uint32_t point) {
    const std::uint32_t light = first_ + point;
    TileMask lit = {};
    std::uint64_t probes = 0, matter = 0;
    for (std::uint32_t k = 0; k < receivers_.count; ++k) {
      const std::uint32_t place = receivers_.pixel[k];
      const Surface& s = shadows_->surface[place];
      LightSample sample;
      if (!lights_up(frame_, s, run_, frame_.lights[light], &sample)) continue;
      lit.set(place);
      if (light < kTileSampleMax) shadows_->sample[light][place] = {sample.direction, sample.irradiance};
      if (!(dot(s.geometric, sample.direction) > 0)) continue;
      probes |= std::uint64_t(1) << place;
      if (!cannot_matter(frame_, s, sample)) matter |= std::uint64_t(1) << place;
    }
    shadows_->lit[light] = lit;
    probes_[point] = probes, known_[point] = blocked_[point] = 0;
    return matter;
  }

  // Adds the rays of pixels from which the point is a probe to the packet, unless their result is known.
  void add_rays(std::uint32_t point, std::uint64_t pixels) {
    const std::uint64_t fresh = pixels & probes_[point] & ~known_[point];
    const Vec3& position = frame_.lights[first_ + point].position;
    known_[point] |= fresh;
    for (std::uint64_t rest = fresh; rest; rest &= rest - 1) {
      const std::uint32_t place = static_cast<std::uint32_t>(__builtin_ctzll(rest));
      if (packet_.count == kPacketMax) trace();
      pixel_[packet_.count] = static_cast<std::uint8_t>(place),
      point_[packet_.count] = static_cast<std::uint8_t>(point);
      set_ray(&packet_, packet_.count++, {receivers_.origin[place], position - shadows_->surface[place].point, 1});
    }
  }
  void trace() {
    if (packet_.count == 0) return;
    tracer_->rays[static_cast<int>(RayKind::shadow)] += packet_.count;
    for (std::uint64_t found = trace_packet(tracer_, packet_, frame_.lights[first_].material); found;
         found &= found - 1) {
      const int ray = __builtin_ctzll(found);
      blocked_[point_[ray]] |= std::uint64_t(1) << pixel_[ray];
    }
    packet_.count = 0;
  }

  void test(const PointGroup& group, std::uint64_t pixels) {
    if (!group.second) {
      for (std::uint32_t i = group.begin; i < group.end; ++i) add_rays(order_[i], pixels);
      return trace();
    }
    // Few rays are faster in one packet, even if some of them are not needed.
    const bool at_once = __builtin_popcountll(pixels) <= kTogetherMax;
    for (std::uint32_t i = 0; at_once && i < std::size(group.probes); ++i) add_rays(group.probes[i], pixels);
    trace();
    std::uint64_t all = pixels, none = pixels;  // blocked
    for (std::uint32_t point : group.probes) {
      add_rays(point, all | none);
      trace();
      all &= blocked_[point], none &= probes_[point] & ~blocked_[point];
    }
    for (std::uint32_t i = group.begin; i < group.end; ++i) {
      const std::uint32_t point = order_[i];
      known_[point] |= (all | none) & probes_[point];
      blocked_[point] = (blocked_[point] & ~none) | (all & probes_[point]);
    }
    const std::uint64_t rest = pixels & ~(all | none);
    if (!rest) return;
    test(*(&group + 1), rest);
    test(groups_[group.second], rest);
  }

  Tracer* tracer_;
  const FrameData& frame_;
  const LightRun& run_;
  std::uint32_t first_;
  const Receivers& receivers_;
  TileShadows* shadows_;
  const PointGroup* groups_;
  const std::uint8_t* order_;
  SegmentPacket packet_;
  std::uint8_t pixel_[kPacketMax], point_[kPacketMax];                                   // of its rays
  std::uint64_t probes_[kTileLightMax], known_[kTileLightMax], blocked_[kTileLightMax];  // by point
};

}  // namespace

void find_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  Receivers receivers;
  find_receivers(frame, rays, hits, shadows, &receivers);
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    for (std::uint32_t i = run.begin; i < run.end && i < kTileLightMax; ++i)
      trace_light(tracer, run, i, receivers, shadows);
  }
}

void find_grouped_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  const PointGroups& groups = frame.point_groups;
  Receivers receivers;
  find_receivers(frame, rays, hits, shadows, &receivers);
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    const bool is_grouped = run.begin == groups.first_point;
    const std::uint32_t step = is_grouped ? groups.points_of_light : 1;
    for (std::uint32_t i = run.begin; i < run.end && i < kTileLightMax; i += step) {
      if (is_grouped)
        TilePoints(tracer, run, i, receivers, shadows).find();
      else
        trace_light(tracer, run, i, receivers, shadows);
    }
  }
}

}  // namespace pocketray
