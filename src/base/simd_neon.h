// Four lanes, NEON of aarch64. See simd.h.
#pragma once
#include <arm_neon.h>

#include <cstdint>

namespace pocketray {

struct Mask4 {
  uint32x4_t v;
};
struct Float4 {
  float32x4_t v;
  static constexpr int kLanes = 4;
  static Float4 splat(float x) { return {vdupq_n_f32(x)}; }
  static Float4 load(const float* p) { return {vld1q_f32(p)}; }
  static Float4 load3(const float* p) {
    const float lanes[4] = {p[0], p[1], p[2], 0};
    return {vld1q_f32(lanes)};
  }
  static Float4 repeat(Float4 a) { return a; }
  static Float4 spread(const float* p) { return splat(*p); }
  static Mask4 mask_of(unsigned bits) {
    const std::uint32_t lane[4] = {1, 2, 4, 8};
    return {vtstq_u32(vdupq_n_u32(bits), vld1q_u32(lane))};
  }
};
inline void store(float* p, Float4 a) { vst1q_f32(p, a.v); }
inline void load_points(const float* const (&p)[4], Float4 (&rows)[3]) {
  float32x4x3_t r = {{vdupq_n_f32(0), vdupq_n_f32(0), vdupq_n_f32(0)}};
  r = vld3q_lane_f32(p[0], r, 0), r = vld3q_lane_f32(p[1], r, 1);
  r = vld3q_lane_f32(p[2], r, 2), r = vld3q_lane_f32(p[3], r, 3);
  for (int axis = 0; axis < 3; ++axis) rows[axis].v = r.val[axis];
}
inline Float4 operator+(Float4 a, Float4 b) { return {vaddq_f32(a.v, b.v)}; }
inline Float4 operator-(Float4 a, Float4 b) { return {vsubq_f32(a.v, b.v)}; }
inline Float4 operator*(Float4 a, Float4 b) { return {vmulq_f32(a.v, b.v)}; }
inline Float4 operator/(Float4 a, Float4 b) { return {vdivq_f32(a.v, b.v)}; }
inline Float4 min(Float4 a, Float4 b) { return {vminq_f32(a.v, b.v)}; }
inline Float4 abs(Float4 a) { return {vabsq_f32(a.v)}; }
inline Float4 max(Float4 a, Float4 b) { return {vmaxq_f32(a.v, b.v)}; }

inline Mask4 operator<=(Float4 a, Float4 b) { return {vcleq_f32(a.v, b.v)}; }
inline Mask4 operator<(Float4 a, Float4 b) { return {vcltq_f32(a.v, b.v)}; }
inline Mask4 operator==(Float4 a, Float4 b) { return {vceqq_f32(a.v, b.v)}; }
inline Mask4 operator&(Mask4 a, Mask4 b) { return {vandq_u32(a.v, b.v)}; }
inline Mask4 operator|(Mask4 a, Mask4 b) { return {vorrq_u32(a.v, b.v)}; }
inline Float4 select(Mask4 m, Float4 a, Float4 b) { return {vbslq_f32(m.v, a.v, b.v)}; }
inline float lowest(Float4 a) { return vminvq_f32(a.v); }
inline float highest(Float4 a) { return vmaxvq_f32(a.v); }
inline unsigned bits(Mask4 m) {
  const std::uint32_t weights[4] = {1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(m.v, vld1q_u32(weights)));
}

inline unsigned signs(Float4 a) { return bits(Mask4{vcltq_s32(vreinterpretq_s32_f32(a.v), vdupq_n_s32(0))}); }
inline Float4 copy_sign(Float4 a, Float4 sign) { return {vbslq_f32(vdupq_n_u32(1u << 31), sign.v, a.v)}; }
inline float first(Float4 a) { return vgetq_lane_f32(a.v, 0); }
template <int kLane>
Float4 lane(Float4 a) {
  return {vdupq_laneq_f32(a.v, kLane)};
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
  return vmaxvq_u32(vbicq_u32(vld1q_u32(words), m.v));
}

struct Double4 {
  float64x2_t low, high;
  static Double4 splat(double x) { return {vdupq_n_f64(x), vdupq_n_f64(x)}; }
};
inline Double4 widen(Float4 a) { return {vcvt_f64_f32(vget_low_f32(a.v)), vcvt_high_f64_f32(a.v)}; }
inline Double4 operator+(Double4 a, Double4 b) { return {vaddq_f64(a.low, b.low), vaddq_f64(a.high, b.high)}; }
inline Double4 operator-(Double4 a, Double4 b) { return {vsubq_f64(a.low, b.low), vsubq_f64(a.high, b.high)}; }
inline Double4 operator*(Double4 a, Double4 b) { return {vmulq_f64(a.low, b.low), vmulq_f64(a.high, b.high)}; }

inline Double4 operator/(Double4 a, Double4 b) { return {vdivq_f64(a.low, b.low), vdivq_f64(a.high, b.high)}; }
inline Double4 min(Double4 a, Double4 b) {
  return {vminq_f64(a.low, b.low), vminq_f64(a.high, b.high)};
}
inline Double4 max(Double4 a, Double4 b) {
  return {vmaxq_f64(a.low, b.low), vmaxq_f64(a.high, b.high)};
}
inline Float4 narrow(Double4 a) { return {vcvt_high_f32_f64(vcvt_f32_f64(a.low), a.high)}; }

struct DoubleMask4 {
  uint64x2_t low, high;
};
inline DoubleMask4 operator<=(Double4 a, Double4 b) { return {vcleq_f64(a.low, b.low), vcleq_f64(a.high, b.high)}; }
inline DoubleMask4 operator<(Double4 a, Double4 b) { return {vcltq_f64(a.low, b.low), vcltq_f64(a.high, b.high)}; }
inline DoubleMask4 operator&(DoubleMask4 a, DoubleMask4 b) {
  return {vandq_u64(a.low, b.low), vandq_u64(a.high, b.high)};
}
inline DoubleMask4 operator|(DoubleMask4 a, DoubleMask4 b) {
  return {vorrq_u64(a.low, b.low), vorrq_u64(a.high, b.high)};
}
inline Double4 select(DoubleMask4 m, Double4 a, Double4 b) {
  return {vbslq_f64(m.low, a.low, b.low), vbslq_f64(m.high, a.high, b.high)};
}
inline unsigned bits(DoubleMask4 m) { return bits(Mask4{vcombine_u32(vmovn_u64(m.low), vmovn_u64(m.high))}); }

}  // namespace pocketray
