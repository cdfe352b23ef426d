// Tells which rays meet no denormals, so that NEON of 32-bit ARM, which flushes them, traces them exactly.
//
// If all coordinates of vertices and origin are 0 or at least 2^-62, a difference of two of them is a multiple of
// 2^-85, an ulp of the smaller one. With shears that are 0 or at least 2^-40, the sheared coordinates of
// cross_triangle() are then 0 or at least 2^-125: normal, so that NEON computes the same. Products of them in an edge
// function may be flushed. Flushing keeps order: it makes an edge function 0 at worst and never changes its sign, and
// triangles with an edge function of 0 are left to cross_triangle(), in the VFP. Bounds on errors include kUnderflow.
// With directions below 2^30, a triangle all in front of the origin has t of 2^-115 or more; one that straddles it
// passes depth bounds even if they are flushed to 0.
//
// All other rays are traced by the kernels of the baseline.
#pragma once
#include <cmath>
#include <cstring>
#include <limits>

#include "accel/accel.h"
#include "base/isa.h"
#include "base/scan.h"

namespace pocketray {

constexpr float kCoordinateMin = 0x1p-62f;

// Smallest magnitude of a coordinate other than 0; infinity if all are 0. Returns 0 where no kernel flushes denormals,
// since it is not needed.
inline float least_coordinate(Array<const Vec3> positions) {
#if defined(POCKETRAY_HAVE_NEON32)
  return least_magnitude(positions);
#else
  (void)positions;
  return 0;
#endif
}

// Magnitude of a float as an integer, which sorts like it. Less one, 0 becomes the greatest of all.
inline std::uint32_t shifted_magnitude(float x) {
  std::uint32_t word;
  std::memcpy(&word, &x, sizeof word);
  return word << 1;
}

// Extremes of the numbers of some rays, as integers, from which it follows whether any denormal can occur.
class DenormalGuard {
 public:
  std::uint32_t coordinate = ~0u, end = ~0u;  // least magnitude of an origin's coordinate, least positive end; less one
  std::uint32_t span = 0, reach = 0;  // most: quotient of a direction's components, component above kDirectionMin

  void add_origin(const Vec3& origin) {
    for (int axis = 0; axis < 3; ++axis) keep_least(shifted_magnitude(origin[axis]) - 1, &coordinate);
  }
  void add_direction(float x, float y, float z) {
    std::uint32_t a = shifted_magnitude(x), b = shifted_magnitude(y), c = shifted_magnitude(z);
    std::uint32_t most = a > b ? a : b, least = a - 1 < b - 1 ? a - 1 : b - 1;
    if (c > most) most = c;
    if (c - 1 < least) least = c - 1;
    keep_most(most - least, &span), keep_most(most - kDirectionMin, &reach);
  }
  void add_end(float t_max) {
    std::uint32_t word;
    std::memcpy(&word, &t_max, sizeof word);
    keep_least(word - 1, &end);
  }
  bool is_safe() const {
    return coordinate >= kCoordinateBits - 1 && end >= kCoordinateBits / 2 - 1 && span <= kShearSpan + 1 &&
           reach <= kDirectionMax - kDirectionMin;
  }

  static constexpr std::uint32_t kDirectionMin = (127u - 60) << 24, kDirectionMax = (127u + 30) << 24;  // 2^-60, 2^30

 private:
  static constexpr std::uint32_t kShearSpan = 40u << 24;
  static constexpr std::uint32_t kCoordinateBits = (127u - 62) << 24;  // kCoordinateMin as bits
  static void keep_least(std::uint32_t value, std::uint32_t* least) {
    if (value < *least) *least = value;
  }
  static void keep_most(std::uint32_t value, std::uint32_t* most) {
    if (value > *most) *most = value;
  }
};

inline bool is_safe_to_flush(const Accel& accel, const Ray& ray) {
  DenormalGuard guard;
  guard.add_origin(ray.origin);
  guard.add_direction(ray.direction.x, ray.direction.y, ray.direction.z);
  guard.add_end(ray.t_max);
  return guard.is_safe() && accel.least_coordinate >= kCoordinateMin;
}
// Adds the rays of a packet from number `first` on.
inline void add_directions(const float (&rows)[3][kPacketMax], std::uint32_t first, std::uint32_t count,
                           DenormalGuard* guard) {
  for (std::uint32_t i = first; i < count; ++i) guard->add_direction(rows[0][i], rows[1][i], rows[2][i]);
}
inline void add_segments(const SegmentPacket& rays, std::uint32_t first, DenormalGuard* guard) {
  add_directions(rays.direction, first, rays.count, guard);
  for (std::uint32_t i = first; i < rays.count; ++i)
    guard->add_origin({rays.origin[0][i], rays.origin[1][i], rays.origin[2][i]}), guard->add_end(rays.t_max[i]);
}

inline bool is_safe_to_flush(const Accel& accel, const RayPacket& rays) {
  DenormalGuard guard;
  guard.add_origin(rays.origin), guard.add_end(rays.t_max);
  add_directions(rays.direction, 0, rays.count, &guard);
  return guard.is_safe() && accel.least_coordinate >= kCoordinateMin;
}
inline bool is_safe_to_flush(const Accel& accel, const SegmentPacket& rays) {
  DenormalGuard guard;
  add_segments(rays, 0, &guard);
  return guard.is_safe() && accel.least_coordinate >= kCoordinateMin;
}

#if defined(POCKETRAY_HAVE_NEON32)
// Four rays at a time; part of the NEON kernels.
bool is_safe_to_flush_by_fours(const Accel& accel, const RayPacket& rays);
bool is_safe_to_flush_by_fours(const Accel& accel, const SegmentPacket& rays);
#endif

}  // namespace pocketray
