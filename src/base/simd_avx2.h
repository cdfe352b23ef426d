// Eight lanes, AVX2. See simd.h.
#pragma once
#include <immintrin.h>

#include "base/simd_sse2.h"

namespace pocketray {

struct Mask8 {
  __m256 v;
};
struct Float8 {
  __m256 v;
  static constexpr int kLanes = 8;
  static Float8 splat(float x) { return {_mm256_set1_ps(x)}; }
  static Float8 load(const float* p) { return {_mm256_load_ps(p)}; }
  static Float8 repeat(Float4 a) { return {_mm256_set_m128(a.v, a.v)}; }
  static Float8 spread(const float* p) { return {_mm256_set_m128(_mm_set1_ps(p[1]), _mm_set1_ps(p[0]))}; }
  static Mask8 mask_of(unsigned bits) {
    const __m256i lane = _mm256_set_epi32(128, 64, 32, 16, 8, 4, 2, 1);
    __m256i all = _mm256_set1_epi32(static_cast<int>(bits));
    return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(all, lane), lane))};
  }
};
inline void store(float* p, Float8 a) { _mm256_store_ps(p, a.v); }
inline Float8 operator+(Float8 a, Float8 b) { return {_mm256_add_ps(a.v, b.v)}; }
inline Float8 operator-(Float8 a, Float8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
inline Float8 operator*(Float8 a, Float8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
inline Float8 operator/(Float8 a, Float8 b) { return {_mm256_div_ps(a.v, b.v)}; }
inline Float8 min(Float8 a, Float8 b) { return {_mm256_min_ps(a.v, b.v)}; }
inline Float8 max(Float8 a, Float8 b) { return {_mm256_max_ps(a.v, b.v)}; }
inline Float8 abs(Float8 a) { return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)}; }
inline Mask8 operator<=(Float8 a, Float8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OS)}; }
inline Mask8 operator<(Float8 a, Float8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OS)}; }
inline Mask8 operator==(Float8 a, Float8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ)}; }
inline Mask8 operator&(Mask8 a, Mask8 b) { return {_mm256_and_ps(a.v, b.v)}; }
inline Mask8 operator|(Mask8 a, Mask8 b) { return {_mm256_or_ps(a.v, b.v)}; }
inline unsigned bits(Mask8 m) { return static_cast<unsigned>(_mm256_movemask_ps(m.v)); }
inline Float8 select(Mask8 m, Float8 a, Float8 b) { return {_mm256_blendv_ps(b.v, a.v, m.v)}; }
inline float lowest(Float8 a) {
  return lowest(Float4{_mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1))});
}
inline float highest(Float8 a) {
  return highest(Float4{_mm_max_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1))});
}

struct Double8 {
  __m256d low, high;
  static Double8 splat(double x) { return {_mm256_set1_pd(x), _mm256_set1_pd(x)}; }
};
inline Double8 widen(Float8 a) {
  return {_mm256_cvtps_pd(_mm256_castps256_ps128(a.v)), _mm256_cvtps_pd(_mm256_extractf128_ps(a.v, 1))};
}
inline Float8 narrow(Double8 a) { return {_mm256_set_m128(_mm256_cvtpd_ps(a.high), _mm256_cvtpd_ps(a.low))}; }
inline Double8 operator+(Double8 a, Double8 b) { return {_mm256_add_pd(a.low, b.low), _mm256_add_pd(a.high, b.high)}; }
inline Double8 operator-(Double8 a, Double8 b) { return {_mm256_sub_pd(a.low, b.low), _mm256_sub_pd(a.high, b.high)}; }
inline Double8 operator*(Double8 a, Double8 b) { return {_mm256_mul_pd(a.low, b.low), _mm256_mul_pd(a.high, b.high)}; }
inline Double8 operator/(Double8 a, Double8 b) { return {_mm256_div_pd(a.low, b.low), _mm256_div_pd(a.high, b.high)}; }
inline Double8 min(Double8 a, Double8 b) { return {_mm256_min_pd(a.low, b.low), _mm256_min_pd(a.high, b.high)}; }
inline Double8 max(Double8 a, Double8 b) { return {_mm256_max_pd(a.low, b.low), _mm256_max_pd(a.high, b.high)}; }

struct DoubleMask8 {
  __m256d low, high;
};
inline DoubleMask8 operator<=(Double8 a, Double8 b) {
  return {_mm256_cmp_pd(a.low, b.low, _CMP_LE_OS), _mm256_cmp_pd(a.high, b.high, _CMP_LE_OS)};
}
inline DoubleMask8 operator<(Double8 a, Double8 b) {
  return {_mm256_cmp_pd(a.low, b.low, _CMP_LT_OS), _mm256_cmp_pd(a.high, b.high, _CMP_LT_OS)};
}
inline DoubleMask8 operator&(DoubleMask8 a, DoubleMask8 b) {
  return {_mm256_and_pd(a.low, b.low), _mm256_and_pd(a.high, b.high)};
}
inline DoubleMask8 operator|(DoubleMask8 a, DoubleMask8 b) {
  return {_mm256_or_pd(a.low, b.low), _mm256_or_pd(a.high, b.high)};
}
inline unsigned bits(DoubleMask8 m) {
  return static_cast<unsigned>(_mm256_movemask_pd(m.low) | _mm256_movemask_pd(m.high) << 4);
}
inline Double8 select(DoubleMask8 m, Double8 a, Double8 b) {
  return {_mm256_blendv_pd(b.low, a.low, m.low), _mm256_blendv_pd(b.high, a.high, m.high)};
}

template <>
struct Lanes<8> {
  using Floats = Float8;
  using Doubles = Double8;
};

}  // namespace pocketray
