#include "temporal/shadow_rays.h"

namespace pocketray {
namespace {

bool accept_moving(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& f = *static_cast<const ShadowFilters*>(context);
  return f.inner.accept(f.inner.context, f.geometry.ids[triangle], u, v);
}
bool accept_other(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& f = *static_cast<const ShadowFilters*>(context);
  if (moving_index(f.geometry, triangle) != kNoTriangle) return false;
  return !f.inner.accept || f.inner.accept(f.inner.context, triangle, u, v);
}

}  // namespace

ShadowFilters::ShadowFilters(const MovingGeometry& geometry_, const HitFilter& inner_)
    : geometry(geometry_), inner(inner_), moving{accept_moving, this}, other{accept_other, this} {}

std::uint64_t blocked_among(const AccelTraversal& traversal, const Accel& accel, const ShadowRays& s,
                            std::uint64_t which, const HitFilter* filter, TraceStats* stats) {
  if (which == 0) return 0;
  SegmentPacket some;
  std::uint8_t place[kPacketMax];
  some.count = 0;
  for (std::uint64_t rest = which; rest; rest &= rest - 1) {
    place[some.count] = static_cast<std::uint8_t>(__builtin_ctzll(rest));
    set_ray(&some, some.count, ray_of(s.rays, place[some.count]));
    ++some.count;
  }
  std::uint64_t found = traversal.occluded_packet(accel, some, filter, stats), blocked = 0;
  for (std::uint32_t i = 0; i < some.count; ++i) blocked |= (found >> i & 1) << place[i];
  return blocked;
}

}  // namespace pocketray
