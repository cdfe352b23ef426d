// Rays from one point, prepared for traversal of the BVH. Part of the kernels: see bvh_packet.h.
//
// Seen along the dominant axis of their directions, the rays are points q of the plane at depth 1, |q| ≤ 1, and so is
// everything they can hit. Windows of the plane that contain such points decide what can be skipped. Edge lines are
// relative to the middle of the packet's window: coordinates there are small, and so are their rounding errors.
//
// How far the windows are widened: cross_triangle() accepts hits of rays that miss the triangle by up to 4u of the
// depth z of its vertices (u = 2^-24: the shear, two products, a difference), which is 4u in the plane. Projections and
// pyramids round by a few more u. 16u = 2^-20 covers both.
#pragma once
#include <cmath>
#include <limits>

#include "accel/ray.h"
#include "base/simd.h"

namespace pocketray {
inline namespace POCKETRAY_ISA {

constexpr float kPacketSlack = 0x1p-20f;
// Exceeds the total loss to underflow in a few operations.
constexpr float kUnderflow = kFlushesDenormals ? 0x1p-110f : 0x1p-140f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A rectangle of the plane.
struct Window {
  float x_low, x_high, y_low, y_high;
};

// Four rectangles, also as centre and half size.
struct alignas(16) Windows4 {
  float x_low[4], x_high[4], y_low[4], y_high[4], x[4], y[4], half_x[4], half_y[4];
};
inline void set_window(Windows4* w, int i, const Window& window) {
  w->x_low[i] = window.x_low, w->x_high[i] = window.x_high, w->y_low[i] = window.y_low, w->y_high[i] = window.y_high;
  w->x[i] = (window.x_low + window.x_high) * 0.5f, w->y[i] = (window.y_low + window.y_high) * 0.5f;
  w->half_x[i] = (window.x_high - window.x_low) * 0.5f, w->half_y[i] = (window.y_high - window.y_low) * 0.5f;
}

inline Window hull(const Windows4& w) {
  return {lowest(Float4::load(w.x_low)), highest(Float4::load(w.x_high)), lowest(Float4::load(w.y_low)),
          highest(Float4::load(w.y_high))};
}

// The rays of a packet with the same dominant axis and sign of direction. A group is four rays, a block four groups.
struct Packet {
  int kx, ky, kz;
  float sign;  // of the directions along kz
  Vec3 origin;
  float t_max;
  const HitFilter* filter;
  const float *direction_x, *direction_y, *direction_z;  // by kx, ky, kz; padded for the widest lanes
  const std::uint8_t* place;                             // ray's index in the caller's arrays
  int count;                                             // a multiple of sixteen
  bool has_groups;
  float all_far;  // bound on the depth of a hit that counts, for any ray
  float middle_x, middle_y, half_x, half_y;
  Float4 sign4, origin4[3], middle4[2], half4[2];  // the same value in all lanes
  Float4 window4[4];                               // window of all rays, in all lanes: low and high x, low and high y
  alignas(64) float x[kPacketMax], y[kPacketMax];  // q: the shears of the ray, times sign
  alignas(64) float far[kPacketMax];               // depth bound of each ray; −∞ in the padding of the last group
  alignas(64) float group_far[kPacketMax / 4];
  // The nearest hits so far; without one, t is t_max and triangle kNoTriangle.
  alignas(64) float t[kPacketMax], u[kPacketMax], v[kPacketMax];
  alignas(64) std::uint32_t triangle[kPacketMax];
  Windows4 block, group[4];
};

// Upper bound of the depth of hits at t along a direction with this component.
inline float depth_bound(float t, float direction_z) {
  return (t + std::numeric_limits<float>::denorm_min()) * std::fabs(direction_z) * (1 + kPacketSlack);
}
template <class F>
inline F depth_bound(F t, F direction_z) {
  return (t + F::splat(std::numeric_limits<float>::denorm_min())) * abs(direction_z) * F::splat(1 + kPacketSlack);
}

// Computes everything but the groups from axes, origin and directions.
inline void prepare_packet(Packet* p) {
  Float4 x_low = Float4::splat(kInfinity), x_high = Float4::splat(-kInfinity), y_low = x_low, y_high = x_high;
  Float4 sign = Float4::splat(p->sign), far = x_high, t_max = Float4::splat(p->t_max);
  for (int i = 0; i < p->count; i += 4) {
    Float4 dz = Float4::load(p->direction_z + i);
    Float4 x = Float4::load(p->direction_x + i) / dz * sign, y = Float4::load(p->direction_y + i) / dz * sign;
    Float4 bound = depth_bound(t_max, dz);
    x_low = min(x_low, x), x_high = max(x_high, x), y_low = min(y_low, y), y_high = max(y_high, y);
    far = max(far, bound);
    store(p->x + i, x), store(p->y + i, y), store(p->far + i, bound);
  }
  float low_x = lowest(x_low) - kPacketSlack, high_x = highest(x_high) + kPacketSlack;
  float low_y = lowest(y_low) - kPacketSlack, high_y = highest(y_high) + kPacketSlack;
  p->window4[0] = Float4::splat(low_x), p->window4[1] = Float4::splat(high_x);
  p->window4[2] = Float4::splat(low_y), p->window4[3] = Float4::splat(high_y);
  p->middle_x = (low_x + high_x) * 0.5f, p->middle_y = (low_y + high_y) * 0.5f;
  p->half_x = (high_x - low_x) * 0.5f + kPacketSlack, p->half_y = (high_y - low_y) * 0.5f + kPacketSlack;
  p->all_far = highest(far);
  p->has_groups = false;
  p->sign4 = sign;
  p->origin4[0] = Float4::splat(p->origin[p->kx]), p->origin4[1] = Float4::splat(p->origin[p->ky]);
  p->origin4[2] = Float4::splat(p->origin[p->kz]);
}

inline void update_all_far(Packet* p) {
  p->all_far = highest(max(max(Float4::load(p->group_far), Float4::load(p->group_far + 4)),
                           max(Float4::load(p->group_far + 8), Float4::load(p->group_far + 12))));
}

// Data that only leaves need, computed at the first leaf.
inline void prepare_groups(Packet* p) {
  p->has_groups = true;
  p->middle4[0] = Float4::splat(p->middle_x), p->middle4[1] = Float4::splat(p->middle_y);
  p->half4[0] = Float4::splat(p->half_x), p->half4[1] = Float4::splat(p->half_y);
  for (int g = 0; g < static_cast<int>(kPacketMax) / 4; ++g) {
    Windows4& w = p->group[g / 4];
    if (4 * g >= p->count) {
      set_window(&w, g % 4, {4, 4, 4, 4});  // outside everything visible
      p->group_far[g] = -kInfinity;
      store(p->far + 4 * g, Float4::splat(-kInfinity));
      continue;
    }
    Float4 x = Float4::load(p->x + 4 * g), y = Float4::load(p->y + 4 * g);
    set_window(
        &w, g % 4,
        {lowest(x) - kPacketSlack, highest(x) + kPacketSlack, lowest(y) - kPacketSlack, highest(y) + kPacketSlack});
    p->group_far[g] = highest(Float4::load(p->far + 4 * g));
    store(p->t + 4 * g, Float4::splat(p->t_max));
  }
  for (std::uint32_t& triangle : p->triangle) triangle = kNoTriangle;
  for (int b = 0; b < 4; ++b) set_window(&p->block, b, hull(p->group[b]));
}

}  // namespace POCKETRAY_ISA
}  // namespace pocketray
