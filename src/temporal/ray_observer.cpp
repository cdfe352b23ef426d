#include "temporal/ray_observer.h"

#include "base/check.h"

namespace pocketray {
namespace {

const MarkingObserver& observer_of(const TraceStats* stats) {
  CHECK(stats && stats->observer);
  return *static_cast<const MarkingObserver*>(stats->observer);
}

void mark(const MarkingObserver& o, const Ray& ray, float t_end) {
  // Threads may mark one pixel at once: they trace pixels for those of others around them, too.
  __atomic_store_n(&o.marked[std::size_t(o.row) * o.tables->width + o.column], std::uint8_t(1), __ATOMIC_RELAXED);
  mark_ray(*o.tables, ray, t_end, block_of(*o.tables, o.column, o.row));
}

void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  const MarkingObserver& o = observer_of(stats);
  o.accel_info->closest(accel, ray, filter, hit, stats);
  mark(o, ray, hit->triangle == kNoTriangle ? ray.t_max : hit->t);
}

bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  const MarkingObserver& o = observer_of(stats);
  mark(o, ray, ray.t_max);
  return o.accel_info->occluded(accel, ray, filter, stats);
}

}  // namespace

AccelInfo observed(const AccelInfo& accel_info) {
  AccelInfo info = accel_info;
  info.closest = closest;
  info.occluded = occluded;
  return info;
}

}  // namespace pocketray
