// Rays and hits.
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFu;

// Points origin + t·direction with 0 < t < t_max. The direction need not be unit; t is in units of its length. A ray
// with a non-finite origin or a zero or non-finite direction hits nothing (HARDCASES row 9). A shadow ray can name the
// triangles on which it begins and ends: these do not block it (only occluded() reads them), so that rounding cannot
// make them block it and no time is spent on them.
struct Ray {
  Vec3 origin, direction;
  float t_max;
  std::uint32_t from = kNoTriangle, to = kNoTriangle;
};
inline bool joins(const Ray& ray, std::uint32_t triangle) { return triangle == ray.from || triangle == ray.to; }

// Rays with a common origin, such as those of a block of pixels. Neighbours should be adjacent, in squares of four, of
// sixteen … (Morton order). Directions as in Ray, by axis.
constexpr std::uint32_t kPacketMax = 64;
struct RayPacket {
  Vec3 origin;
  float t_max;
  std::uint32_t count;  // up to kPacketMax
  alignas(64) float direction[3][kPacketMax];
};

inline Ray ray_of(const RayPacket& rays, std::uint32_t i) {
  return {rays.origin, {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]}, rays.t_max};
}

// Rays with individual origins and ends. Fast for coherent rays, such as those to one light or along one direction,
// with neighbours adjacent as in RayPacket. They name only the triangles on which they begin.
struct SegmentPacket {
  std::uint32_t count;  // up to kPacketMax
  alignas(64) float origin[3][kPacketMax], direction[3][kPacketMax], t_max[kPacketMax];
  std::uint32_t from[kPacketMax];
};

inline Ray ray_of(const SegmentPacket& rays, std::uint32_t i) {
  return {{rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]},
          {rays.direction[0][i], rays.direction[1][i], rays.direction[2][i]},
          rays.t_max[i],
          rays.from[i]};
}
inline void set_ray(SegmentPacket* rays, std::uint32_t i, const Ray& ray) {
  for (int axis = 0; axis < 3; ++axis)
    rays->origin[axis][i] = ray.origin[axis], rays->direction[axis][i] = ray.direction[axis];
  rays->t_max[i] = ray.t_max, rays->from[i] = ray.from;
}

// Hit point: (1−u−v)·v0 + u·v1 + v·v2.
struct Hit {
  float t, u, v;
  std::uint32_t triangle = kNoTriangle;
};

// Receives the traced pixel and the rays that an accelerator passes on for it; see temporal/ray_observer.h.
struct RayObserver {
  std::uint16_t column = 0, row = 0;
};

// Work counters for --aov cost and bench, and the observer of the rays; one per thread.
struct TraceStats {
  std::uint64_t nodes = 0, triangles = 0;  // nodes of four boxes visited, triangles tested
  RayObserver* observer = nullptr;         // null: none
};

// Decides whether a candidate hit counts; null accepts all. Must depend only on its arguments, and on u and v only if
// it reads the point.
struct HitFilter {
  bool (*accept)(const void* context, std::uint32_t triangle, float u, float v) = nullptr;
  const void* context = nullptr;
  bool reads_point = true;
};

}  // namespace pocketray
