// Rays and hits.
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

constexpr std::uint32_t kNoTriangle = 0xFFFFFFFFu;

// Points origin + t·direction with 0 < t < t_max. The direction need not be unit; t counts in its lengths. A ray with a
// non-finite origin or a zero or non-finite direction hits nothing (HARDCASES row 9).
struct Ray {
  Vec3 origin, direction;
  float t_max;
};

// Rays that share their origin, such as those of a block of pixels; neighbours should follow one another in squares of
// four, of sixteen … (Morton order). Directions as in Ray, by axis.
constexpr std::uint32_t kPacketMax = 64;
struct RayPacket {
  Vec3 origin;
  float t_max;
  std::uint32_t count;  // up to kPacketMax
  alignas(64) float direction[3][kPacketMax];
};

// Point of the hit: (1−u−v)·v0 + u·v1 + v·v2.
struct Hit {
  float t, u, v;
  std::uint32_t triangle = kNoTriangle;
};

// Work done, for --aov cost and bench; one per thread.
struct TraceStats {
  std::uint64_t nodes = 0, triangles = 0;  // boxes-of-four visited, triangles tested
};

// Decides whether a candidate hit counts; null means every one does. Must depend on its arguments alone.
struct HitFilter {
  bool (*accept)(const void* context, std::uint32_t triangle, float u, float v) = nullptr;
  const void* context = nullptr;
};

}  // namespace pocketray
