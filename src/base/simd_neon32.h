// Four floats, NEON of 32-bit ARM; doubles one after the other. See simd.h.
//
// This unit takes denormal operands for 0 and returns 0 in place of denormal results; all else rounds as IEEE
// prescribes. Division is left to the VFP, which handles denormals. min() and max() return NaN for NaN.
#pragma once
#include <arm_neon.h>

#include "base/simd_scalar_doubles.h"

namespace pocketray {
inline namespace neon {

struct Mask4 {
  uint32x4_t v;
};
struct Float4 {
  float32x4_t v;
  static constexpr int kLanes = 4;
  static Float4 splat(float x) { return {vdupq_n_f32(x)}; }
  static Float4 load(const float* p) { return {vld1q_f32(static_cast<const float*>(__builtin_assume_aligned(p, 16)))}; }
  static Float4 load3(const float* p) {
    const float lanes[4] = {p[0], p[1], p[2], 0};
    return {vld1q_f32(lanes)};
  }
  static Float4 repeat(Float4 a) { return a; }
  static Float4 spread(const float* p) { return {vld1q_dup_f32(p)}; }
  static Mask4 mask_of(unsigned bits) {
    const std::uint32_t lane[4] = {1, 2, 4, 8};
    return {vtstq_u32(vdupq_n_u32(bits), vld1q_u32(lane))};
  }
};
inline void store(float* p, Float4 a) { vst1q_f32(static_cast<float*>(__builtin_assume_aligned(p, 16)), a.v); }
inline void load_points(const float* const (&p)[4], Float4 (&rows)[3]) {
  static const float kZeros[12] = {};
  float32x4x3_t r = vld3q_f32(kZeros);  // GCC 12 would set it up in memory
  r = vld3q_lane_f32(p[0], r, 0), r = vld3q_lane_f32(p[1], r, 1);
  r = vld3q_lane_f32(p[2], r, 2), r = vld3q_lane_f32(p[3], r, 3);
  for (int axis = 0; axis < 3; ++axis) rows[axis].v = r.val[axis];
}
inline Float4 operator+(Float4 a, Float4 b) { return {vaddq_f32(a.v, b.v)}; }
inline Float4 operator-(Float4 a, Float4 b) { return {vsubq_f32(a.v, b.v)}; }
inline Float4 operator*(Float4 a, Float4 b) { return {vmulq_f32(a.v, b.v)}; }
inline Float4 operator/(Float4 a, Float4 b) {
  float32x4_t r = vdupq_n_f32(0);
  r = vsetq_lane_f32(vgetq_lane_f32(a.v, 0) / vgetq_lane_f32(b.v, 0), r, 0);
  r = vsetq_lane_f32(vgetq_lane_f32(a.v, 1) / vgetq_lane_f32(b.v, 1), r, 1);
  r = vsetq_lane_f32(vgetq_lane_f32(a.v, 2) / vgetq_lane_f32(b.v, 2), r, 2);
  r = vsetq_lane_f32(vgetq_lane_f32(a.v, 3) / vgetq_lane_f32(b.v, 3), r, 3);
  return {r};
}
// Two Newton steps from eight bits: within 3u.
inline Float4 reciprocal(Float4 a) {
  float32x4_t r = vrecpeq_f32(a.v);
  r = vmulq_f32(r, vrecpsq_f32(a.v, r));
  return {vmulq_f32(r, vrecpsq_f32(a.v, r))};
}
inline Float4 min(Float4 a, Float4 b) { return {vminq_f32(a.v, b.v)}; }
inline Float4 abs(Float4 a) { return {vabsq_f32(a.v)}; }
inline Float4 max(Float4 a, Float4 b) { return {vmaxq_f32(a.v, b.v)}; }

// GCC 12 compares lane by lane, in the VFP, if asked by intrinsics.
inline Mask4 operator<=(Float4 a, Float4 b) {
  Mask4 m;
  asm("vcge.f32 %q0, %q2, %q1" : "=w"(m.v) : "w"(a.v), "w"(b.v));
  return m;
}
inline Mask4 operator<(Float4 a, Float4 b) {
  Mask4 m;
  asm("vcgt.f32 %q0, %q2, %q1" : "=w"(m.v) : "w"(a.v), "w"(b.v));
  return m;
}
inline Mask4 operator==(Float4 a, Float4 b) {
  Mask4 m;
  asm("vceq.f32 %q0, %q1, %q2" : "=w"(m.v) : "w"(a.v), "w"(b.v));
  return m;
}
inline Mask4 operator&(Mask4 a, Mask4 b) { return {vandq_u32(a.v, b.v)}; }
inline Mask4 operator|(Mask4 a, Mask4 b) { return {vorrq_u32(a.v, b.v)}; }
inline Float4 select(Mask4 m, Float4 a, Float4 b) { return {vbslq_f32(m.v, a.v, b.v)}; }
inline float lowest(Float4 a) {
  float32x2_t r = vpmin_f32(vget_low_f32(a.v), vget_high_f32(a.v));
  return vget_lane_f32(vpmin_f32(r, r), 0);
}
inline float highest(Float4 a) {
  float32x2_t r = vpmax_f32(vget_low_f32(a.v), vget_high_f32(a.v));
  return vget_lane_f32(vpmax_f32(r, r), 0);
}
inline unsigned bits(Mask4 m) {
  const std::uint16_t weights[4] = {1, 2, 4, 8};
  uint16x4_t r = vand_u16(vmovn_u32(m.v), vld1_u16(weights));
  return static_cast<unsigned>(vget_lane_u64(vpaddl_u32(vpaddl_u16(r)), 0));
}

inline unsigned signs(Float4 a) { return bits(Mask4{vcltq_s32(vreinterpretq_s32_f32(a.v), vdupq_n_s32(0))}); }
inline Float4 copy_sign(Float4 a, Float4 sign) { return {vbslq_f32(vdupq_n_u32(1u << 31), sign.v, a.v)}; }
inline float first(Float4 a) { return vgetq_lane_f32(a.v, 0); }
template <int kLane>
Float4 lane(Float4 a) {
  if constexpr (kLane < 2)
    return {vdupq_lane_f32(vget_low_f32(a.v), kLane)};
  else
    return {vdupq_lane_f32(vget_high_f32(a.v), kLane - 2)};
}
inline Float4 product_less(Float4 a, Float4 b, Float4 c) { return a * b - c; }
inline Float4 later(Float4 a, Float4 b) {
  return {vreinterpretq_f32_s32(vmaxq_s32(vreinterpretq_s32_f32(a.v), vreinterpretq_s32_f32(b.v)))};
}
inline Float4 sooner(Float4 a, Float4 b) {
  return {vreinterpretq_f32_s32(vminq_s32(vreinterpretq_s32_f32(a.v), vreinterpretq_s32_f32(b.v)))};
}
inline Mask4 is_later(Float4 a, Float4 b) {
  return {vcgtq_s32(vreinterpretq_s32_f32(a.v), vreinterpretq_s32_f32(b.v))};
}
inline std::uint32_t word_outside(Mask4 m, const std::uint32_t* words) {
  uint32x4_t r = vbicq_u32(vld1q_u32(words), m.v);
  uint32x2_t half = vpmax_u32(vget_low_u32(r), vget_high_u32(r));
  return vget_lane_u32(vpmax_u32(half, half), 0);
}

inline Double4 widen(Float4 a) {
  return {{vgetq_lane_f32(a.v, 0), vgetq_lane_f32(a.v, 1), vgetq_lane_f32(a.v, 2), vgetq_lane_f32(a.v, 3)}};
}
inline Float4 narrow(const Double4& a) {
  const float lanes[4] = {static_cast<float>(a.v[0]), static_cast<float>(a.v[1]), static_cast<float>(a.v[2]),
                          static_cast<float>(a.v[3])};
  return {vld1q_f32(lanes)};
}

}  // namespace neon
}  // namespace pocketray
