// Sixteen lanes, AVX-512 (F, DQ). See simd.h.
#pragma once
#include <immintrin.h>

#include "base/simd_sse2.h"

namespace pocketray {

struct Mask16 {
  __mmask16 v;
};
struct Float16 {
  __m512 v;
  static constexpr int kLanes = 16;
  static Float16 splat(float x) { return {_mm512_set1_ps(x)}; }
  static Float16 load(const float* p) { return {_mm512_load_ps(p)}; }
  static Float16 repeat(Float4 a) { return {_mm512_broadcast_f32x4(a.v)}; }
  static Float16 spread(const float* p) {
    const __m512i lane = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
    return {_mm512_permutexvar_ps(lane, _mm512_castps128_ps512(_mm_load_ps(p)))};
  }
  static Mask16 mask_of(unsigned bits) { return {static_cast<__mmask16>(bits)}; }
};
inline void store(float* p, Float16 a) { _mm512_store_ps(p, a.v); }
inline Float16 operator+(Float16 a, Float16 b) { return {_mm512_add_ps(a.v, b.v)}; }
inline Float16 operator-(Float16 a, Float16 b) { return {_mm512_sub_ps(a.v, b.v)}; }
inline Float16 operator*(Float16 a, Float16 b) { return {_mm512_mul_ps(a.v, b.v)}; }
inline Float16 operator/(Float16 a, Float16 b) { return {_mm512_div_ps(a.v, b.v)}; }
inline Float16 min(Float16 a, Float16 b) { return {_mm512_min_ps(a.v, b.v)}; }
inline Float16 max(Float16 a, Float16 b) { return {_mm512_max_ps(a.v, b.v)}; }
inline Float16 abs(Float16 a) { return {_mm512_andnot_ps(_mm512_set1_ps(-0.0f), a.v)}; }
inline Mask16 operator<=(Float16 a, Float16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OS)}; }
inline Mask16 operator<(Float16 a, Float16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OS)}; }
inline Mask16 operator==(Float16 a, Float16 b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ)}; }
inline Mask16 operator&(Mask16 a, Mask16 b) { return {static_cast<__mmask16>(a.v & b.v)}; }
inline Mask16 operator|(Mask16 a, Mask16 b) { return {static_cast<__mmask16>(a.v | b.v)}; }
inline unsigned bits(Mask16 m) { return m.v; }
inline Float16 select(Mask16 m, Float16 a, Float16 b) { return {_mm512_mask_blend_ps(m.v, b.v, a.v)}; }
inline float lowest(Float16 a) { return _mm512_reduce_min_ps(a.v); }
inline float highest(Float16 a) { return _mm512_reduce_max_ps(a.v); }

struct Double16 {
  __m512d low, high;
  static Double16 splat(double x) { return {_mm512_set1_pd(x), _mm512_set1_pd(x)}; }
};
inline Double16 widen(Float16 a) {
  return {_mm512_cvtps_pd(_mm512_castps512_ps256(a.v)), _mm512_cvtps_pd(_mm512_extractf32x8_ps(a.v, 1))};
}
inline Float16 narrow(Double16 a) {
  return {_mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(a.low)), _mm512_cvtpd_ps(a.high), 1)};
}
inline Double16 operator+(Double16 a, Double16 b) {
  return {_mm512_add_pd(a.low, b.low), _mm512_add_pd(a.high, b.high)};
}
inline Double16 operator-(Double16 a, Double16 b) {
  return {_mm512_sub_pd(a.low, b.low), _mm512_sub_pd(a.high, b.high)};
}
inline Double16 operator*(Double16 a, Double16 b) {
  return {_mm512_mul_pd(a.low, b.low), _mm512_mul_pd(a.high, b.high)};
}
inline Double16 operator/(Double16 a, Double16 b) {
  return {_mm512_div_pd(a.low, b.low), _mm512_div_pd(a.high, b.high)};
}
inline Double16 min(Double16 a, Double16 b) { return {_mm512_min_pd(a.low, b.low), _mm512_min_pd(a.high, b.high)}; }
inline Double16 max(Double16 a, Double16 b) { return {_mm512_max_pd(a.low, b.low), _mm512_max_pd(a.high, b.high)}; }

struct DoubleMask16 {
  __mmask8 low, high;
};
inline DoubleMask16 operator<=(Double16 a, Double16 b) {
  return {_mm512_cmp_pd_mask(a.low, b.low, _CMP_LE_OS), _mm512_cmp_pd_mask(a.high, b.high, _CMP_LE_OS)};
}
inline DoubleMask16 operator<(Double16 a, Double16 b) {
  return {_mm512_cmp_pd_mask(a.low, b.low, _CMP_LT_OS), _mm512_cmp_pd_mask(a.high, b.high, _CMP_LT_OS)};
}
inline DoubleMask16 operator&(DoubleMask16 a, DoubleMask16 b) {
  return {static_cast<__mmask8>(a.low & b.low), static_cast<__mmask8>(a.high & b.high)};
}
inline DoubleMask16 operator|(DoubleMask16 a, DoubleMask16 b) {
  return {static_cast<__mmask8>(a.low | b.low), static_cast<__mmask8>(a.high | b.high)};
}
inline unsigned bits(DoubleMask16 m) { return static_cast<unsigned>(m.low | m.high << 8); }
inline Double16 select(DoubleMask16 m, Double16 a, Double16 b) {
  return {_mm512_mask_blend_pd(m.low, b.low, a.low), _mm512_mask_blend_pd(m.high, b.high, a.high)};
}

template <>
struct Lanes<16> {
  using Floats = Float16;
  using Doubles = Double16;
};

}  // namespace pocketray
