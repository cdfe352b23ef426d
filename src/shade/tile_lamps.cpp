#include <algorithm>

#include "shade/point_groups.h"
#include "shade/polygon_light.h"
#include "shade/sample_points.h"
#include "shade/tile_receivers.h"

namespace pocketray {
namespace {

// A lamp as seen from a tile's first hits. Masks have a bit per pixel.
struct TileLamp {
  const LightRun& run;
  std::uint32_t first;  // its first light point
  KnownViews views;     // of its polygon; pixels that it surely lights up see all of it

  std::uint32_t number(const FrameData& frame) const {
    return (first - run.begin) / frame.settings.points_per_area_light;
  }
};

// Computes the pixels' views of the lamp's polygon, if it has one.
void find_views(const Tracer& tracer, const TileReceivers& receivers, TileLamp* lamp, TileShadows* shadows) {
  const FrameData& frame = *tracer.frame;
  const std::uint32_t number = lamp->number(frame);
  if (!lamp->run.polygons || number >= kTilePolygonMax) return;
  const LightPolygon& polygon = lamp->run.polygons[number];
  TilePolygon& tile = shadows->polygons[number];
  if (!polygon.corner_count) return;
  for (std::uint32_t k = 0; k < receivers.count; ++k) {
    const std::uint32_t pixel = receivers.pixel[k];
    const Surface& s = shadows->surface[pixel];
    const LightPoint& point = tracer.light_points[lamp->first];
    if (is_own(frame, s, point) && is_unlit_by_own(frame, s, point)) continue;
    const PolygonView view = tile.view[pixel] = view_polygon(polygon, s);
    tile.viewed.set(pixel);
    if (!view.is_near) continue;
    const Vec3 irradiance = polygon_irradiance(polygon, view);
    if (!(view.form_factor > 0))
      lamp->views.unlit.set(pixel);
    else if (view.is_whole) {
      lamp->views.lit.set(pixel);
      if (!cannot_matter(frame, s, irradiance)) lamp->views.matter.set(pixel);
    }
  }
}

// Keeps the pixels that see all points of the lamp (`open`) and those that see none (`blocked`).
void keep_common(const FrameData& frame, const TileLamp& lamp, std::uint64_t open, std::uint64_t blocked,
                 TileShadows* shadows) {
  const std::uint32_t number = lamp.number(frame);
  if (!lamp.run.polygons || number >= kTilePolygonMax) return;
  shadows->polygons[number].open = mask_of(open & bits_of(lamp.views.matter));
  shadows->polygons[number].blocked = mask_of(blocked & bits_of(lamp.views.matter));
}

// Tests each point of a lamp of which the sample sees few.
void trace_points(Tracer* tracer, const TileLamp& lamp, const TileReceivers& receivers, TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  const std::uint32_t seen_end = lamp.first + tracer->points_of_lamp, end = std::min(seen_end, kTileLightMax);
  std::uint64_t all = ~std::uint64_t(0), any = 0;
  for (std::uint32_t i = lamp.first; i < end; ++i) {
    trace_light(tracer, lamp.run, i, receivers, &lamp.views, shadows);
    const std::uint64_t blocked = bits_of(shadows->blocked[i]);
    all &= blocked, any |= blocked;
  }
  if (end == seen_end) keep_common(frame, lamp, ~any, all, shadows);
}

// The points of one area light as seen from a tile's first hits: is_point_blocked() for all pixels at once.
class TilePoints {
 public:
  TilePoints(Tracer* tracer, const TileLamp& lamp, const TileReceivers& receivers, TileShadows* shadows)
      : tracer_(tracer),
        frame_(*tracer->frame),
        lamp_(lamp),
        first_(lamp.first),
        receivers_(receivers),
        shadows_(shadows) {
    const PointGroups& groups = frame_.lights.point_groups;
    const std::uint32_t place = first_ - groups.first_point;
    groups_ = &groups.groups[place];
    order_ = &groups.order[place];
    packet_.count = 0;
  }

  // For a light whose last points exceed kTileLightMax, finds only which pixels it lights up.
  void find() {
    const std::uint32_t all = frame_.lights.point_groups.points_of_light, count = std::min(all, kTileLightMax - first_);
    std::uint64_t matter = bits_of(lamp_.views.matter), open = ~std::uint64_t(0), blocked = open;
    for (std::uint32_t point = 0; point < count; ++point) matter |= find_probes(point);
    if (count == all) test(groups_[0], matter);
    for (std::uint32_t point = 0; point < count; ++point) {
      shadows_->traced[first_ + point] = {};
      shadows_->decided[first_ + point] = mask_of(known_[point] & matter);
      shadows_->blocked[first_ + point] = mask_of(blocked_[point]);
      open &= ~blocked_[point], blocked &= blocked_[point];
    }
    if (count == all) keep_common(frame_, lamp_, open, blocked, shadows_);
  }

 private:
  // Rays of few pixels to several points share a packet, where each is traced by itself; rays of more pixels converge
  // at a point and are traced together. Instructions a pixel on a Cortex-A7, 16 points, against sharing by 12 pixels:
  // cornell 10 % fewer, McGuire's CornellBox-Original 2 %, CornellBox-Sphere .1 %; without floats cornell 2 % more.
  static constexpr int kTogetherMax = 7;

  // Finds the pixels lit by the point and those for which it is a probe; returns those to which it matters.
  std::uint64_t find_probes(std::uint32_t point) {
    const std::uint32_t light = first_ + point;
    TileMask lit = {};
    std::uint64_t probes = bits_of(lamp_.views.lit), matter = 0;
    for (std::uint32_t k = 0; k < receivers_.count; ++k) {
      const std::uint32_t place = receivers_.pixel[k];
      if (lamp_.views.lit[place] || lamp_.views.unlit[place]) continue;
      const Surface& s = shadows_->surface[place];
      LightSample sample;
      if (!lights_up(frame_, s, lamp_.run, tracer_->light_points[light], &sample)) continue;
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

  // Adds the rays to a point to the packet, for pixels that probe it and do not know the result.
  void add_rays(std::uint32_t point, std::uint64_t pixels) {
    const std::uint64_t fresh = pixels & probes_[point] & ~known_[point];
    const Vec3& position = tracer_->light_points[first_ + point].position;
    if (__builtin_popcountll(fresh) > kTogetherMax) trace();
    begin_point(tracer_->light_points[first_ + point]);
    known_[point] |= fresh;
    for (std::uint64_t rest = fresh; rest; rest &= rest - 1) {
      const std::uint32_t place = static_cast<std::uint32_t>(__builtin_ctzll(rest));
      if (packet_.count == kPacketMax) trace();
      pixel_[packet_.count] = static_cast<std::uint8_t>(place),
      point_[packet_.count] = static_cast<std::uint8_t>(point);
      const Surface& s = shadows_->surface[place];
      set_ray(&packet_, packet_.count++, {receivers_.origin[place], position - s.point, 1, s.hit.triangle});
    }
  }
  // Flushes the packet if the point is in another plane: its rays end in one plane, whose triangles do not block them.
  void begin_point(const LightPoint& light) {
    const bool same = packet_.count == 0 ||
                      (dot(light.direction, light_->direction) > 1 - 0x1p-16f && is_in_plane(*light_, light.position));
    if (!same) trace();
    light_ = &light;
  }
  void trace() {
    if (packet_.count == 0) return;
    tracer_->rays[static_cast<int>(RayKind::shadow)] += packet_.count;
    for (std::uint64_t found = trace_packet(tracer_, packet_, light_); found; found &= found - 1) {
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
    // Few rays are faster together, even if some of them are not needed.
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
  const TileLamp& lamp_;
  std::uint32_t first_;
  const TileReceivers& receivers_;
  TileShadows* shadows_;
  const PointGroup* groups_;
  const std::uint8_t* order_;
  SegmentPacket packet_;
  const LightPoint* light_;                                                              // end of the packet's rays
  std::uint8_t pixel_[kPacketMax], point_[kPacketMax];                                   // by ray
  std::uint64_t probes_[kTileLightMax], known_[kTileLightMax], blocked_[kTileLightMax];  // by point
};

}  // namespace

void find_lamp_tile_shadows(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows) {
  const FrameData& frame = *tracer->frame;
  const PointGroups& groups = frame.lights.point_groups;
  TileReceivers receivers;
  find_receivers(frame, rays, hits, shadows, &receivers);
  for (TilePolygon& polygon : shadows->polygons) polygon.viewed = polygon.open = polygon.blocked = {};
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    const bool has_groups = groups.groups.count && run.begin == groups.first_point;
    const bool has_lamps = has_groups || run.polygons;
    const std::uint32_t step = has_lamps ? frame.settings.points_per_area_light : 1;
    for (std::uint32_t i = run.begin; i < run.end && i < kTileLightMax; i += step) {
      TileLamp lamp = {run, i, {}};
      if (has_lamps) find_views(*tracer, receivers, &lamp, shadows);
      if (has_groups && is_grouped(*tracer))
        TilePoints(tracer, lamp, receivers, shadows).find();
      else if (has_lamps)
        trace_points(tracer, lamp, receivers, shadows);
      else
        trace_light(tracer, run, i, receivers, nullptr, shadows);
    }
  }
}

}  // namespace pocketray
