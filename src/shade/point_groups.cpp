#include "shade/point_groups.h"

#include "base/check.h"
#include "shade/filters.h"
#include "shade/tile_shadows.h"

namespace pocketray {
namespace {

// The points of one area light as seen from a surface, tested ray by ray.
class PointTester {
 public:
  PointTester(Tracer* tracer, const Surface& s, std::uint32_t first, bool at_first_hit)
      : tracer_(tracer), frame_(*tracer->frame), surface_(s), first_(first), at_first_hit_(at_first_hit) {
    TestedPoints& tested = tracer->tested_points;
    if (tested.first == first && tested.triangle == s.hit.triangle && tested.front == s.front &&
        tested.point == s.point && tested.normal == s.normal)
      return;
    tested = {s.point, s.normal, s.hit.triangle, first, s.front, {}, {}, {}, {}};
  }

  bool is_probe(std::uint32_t point, Ray* ray) const {
    LightSample sample;
    if (!pocketray::is_probe(frame_, surface_, run(), tracer_->light_points[first_ + point], &sample)) return false;
    *ray = {safe_origin(surface_, 1), sample.to_light, sample.t_max, surface_.hit.triangle};
    return true;
  }
  // Tests a point that lights up the surface from below its triangle's plane.
  bool test_from_below(std::uint32_t point) {
    LightSample sample;
    CHECK(lights_up(frame_, surface_, run(), tracer_->light_points[first_ + point], &sample));
    return trace(point, {curved_origin(frame_, surface_), sample.to_light, sample.t_max});
  }

  bool is_settled(std::uint32_t point, bool* blocked) const {
    *blocked = has(tracer_->tested_points.blocked, point);
    return has(tracer_->tested_points.settled, point);
  }
  void settle(std::uint32_t point, bool blocked) {
    add(point, &tracer_->tested_points.settled);
    if (blocked) add(point, &tracer_->tested_points.blocked);
  }
  bool test(std::uint32_t point, const Ray& ray) {
    TestedPoints& tested = tracer_->tested_points;
    if (!has(tested.traced, point)) {
      add(point, &tested.traced);
      if (trace(point, ray)) add(point, &tested.met);
    }
    return has(tested.met, point);
  }
  // Returns whether the group's probes agree, which settles all points of it that are probes.
  bool test(const PointGroup& group, const std::uint8_t* order) {
    bool all = true, none = true;
    for (std::uint32_t point : group.probes) {
      Ray ray;
      if (!is_probe(point, &ray)) return false;
      const bool blocked = test(point, ray);
      all &= blocked, none &= !blocked;
      if (!all && !none) return false;
    }
    for (std::uint32_t i = group.begin; i < group.end; ++i) settle(order[i], all);
    return true;
  }

 private:
  static std::uint64_t bit(std::uint32_t point) { return std::uint64_t(1) << point % 64; }
  static bool has(const PointBits& bits, std::uint32_t point) { return (bits[point / 64] & bit(point)) != 0; }
  static void add(std::uint32_t point, PointBits* bits) { (*bits)[point / 64] |= bit(point); }
  const LightRun& run() const { return frame_.lights.runs[frame_.lights.run_count - 1]; }

  bool trace(std::uint32_t point, const Ray& ray) {
    ++tracer_->rays[static_cast<int>(RayKind::shadow)];
    const ShadowContext context = {&frame_, &tracer_->light_points[first_ + point]};
    const HitFilter opaque = {frame_.filters.accept_opaque, &context, frame_.filters.read_point};
    const AccelTraversal& rays = at_first_hit_ ? *frame_.geometry.first_rays : *frame_.geometry.accel_info;
    return rays.occluded(frame_.geometry.accel, ray, &opaque, &tracer_->stats);
  }

  Tracer* tracer_;
  const FrameData& frame_;
  const Surface& surface_;
  std::uint32_t first_;
  bool at_first_hit_;
};

}  // namespace

bool is_point_blocked(Tracer* tracer, const Surface& s, std::uint32_t light, bool at_first_hit) {
  const FrameData& frame = *tracer->frame;
  const PointGroups& groups = frame.lights.point_groups;
  CHECK_GE(light, groups.first_point);
  if (at_first_hit && tracer->tile_shadows && light < kTileLightMax) {
    const TileShadows& tile = *tracer->tile_shadows;
    if (tile.decided[light][tracer->tile_pixel]) return tile.blocked[light][tracer->tile_pixel];
  }
  const std::uint32_t place = light - groups.first_point, emitter = place / groups.points_of_light;
  const std::uint32_t first = groups.first_point + emitter * groups.points_of_light, point = light - first;
  PointTester tester(tracer, s, first, at_first_hit);
  Ray ray;
  if (!tester.is_probe(point, &ray)) return tester.test_from_below(point);
  const PointGroup* all = &groups.groups[emitter * groups.points_of_light];
  const std::uint8_t* order = &groups.order[emitter * groups.points_of_light];
  bool blocked;
  for (const PointGroup* group = all; !tester.is_settled(point, &blocked);) {
    if (!group->second)
      tester.settle(point, tester.test(point, ray));
    else if (!tester.test(*group, order))
      group = groups.place[place] < all[group->second].begin ? group + 1 : &all[group->second];
  }
  return blocked;
}

}  // namespace pocketray
