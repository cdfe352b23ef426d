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

// Collects the rays, and calls trace(packet).
template <class Trace>
std::uint64_t blocked_among(const ShadowRays& s, std::uint64_t which, Trace trace) {
  if (which == 0) return 0;
  SegmentPacket some;
  std::uint8_t place[kPacketMax];
  some.count = 0;
  for (std::uint64_t rest = which; rest; rest &= rest - 1) {
    place[some.count] = static_cast<std::uint8_t>(__builtin_ctzll(rest));
    set_ray(&some, some.count, ray_of(s.rays, place[some.count]));
    ++some.count;
  }
  std::uint64_t found = trace(some), blocked = 0;
  for (std::uint32_t i = 0; i < some.count; ++i) blocked |= (found >> i & 1) << place[i];
  return blocked;
}

}  // namespace

ShadowFilters::ShadowFilters(const MovingGeometry& geometry_, const HitFilter& inner_)
    : geometry(geometry_), inner(inner_), moving{accept_moving, this}, other{accept_other, this} {}

std::uint64_t blocked_by_scene(const FrameData& frame, const ShadowRays& s, std::uint64_t which,
                               const HitFilter* filter, TraceStats* stats) {
  const Geometry& scene = frame.geometry;
  return blocked_among(s, which, [&](const SegmentPacket& some) {
    return scene.first_rays->occluded_packet(scene.accel, some, filter, stats);
  });
}

std::uint64_t blocked_by_moving(const Accel& moving, const ShadowRays& s, std::uint64_t which, const HitFilter* filter,
                                TraceStats* stats) {
  return blocked_among(s, which, [&](SegmentPacket& some) {
    for (std::uint32_t i = 0; i < some.count; ++i) some.from[i] = kNoTriangle;  // its triangles have other numbers
    return kBvhAccel.occluded_packet(moving, some, filter, stats);
  });
}

}  // namespace pocketray
