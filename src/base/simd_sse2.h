// Four lanes, SSE2. See simd.h.
#pragma once
#include <emmintrin.h>
#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif
#if defined(__FMA__)
#include <immintrin.h>
#endif

#include <cstdint>

namespace pocketray {

struct Mask4 {
  __m128 v;
};
struct Float4 {
  __m128 v;
  static constexpr int kLanes = 4;
  static Float4 splat(float x) { return {_mm_set1_ps(x)}; }
  static Float4 load(const float* p) { return {_mm_load_ps(p)}; }
  static Float4 load3(const float* p) { return {_mm_set_ps(0, p[2], p[1], p[0])}; }
  static Float4 repeat(Float4 a) { return a; }
  static Float4 spread(const float* p) { return splat(*p); }
  static Mask4 mask_of(unsigned bits) {
    __m128i lane = _mm_set_epi32(8, 4, 2, 1);
    return {_mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(static_cast<int>(bits)), lane), lane))};
  }
};
inline void store(float* p, Float4 a) { _mm_store_ps(p, a.v); }
inline void load_points(const float* const (&p)[4], Float4 (&rows)[3]) {
  auto xy = [&](int i) { return _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p[i]))); };
  auto z = [&](int i) { return _mm_load_ss(p[i] + 2); };
  __m128 low = _mm_unpacklo_ps(xy(0), xy(1)), high = _mm_unpacklo_ps(xy(2), xy(3));  // x, x, y, y
  rows[0].v = _mm_movelh_ps(low, high), rows[1].v = _mm_movehl_ps(high, low);
  rows[2].v = _mm_movelh_ps(_mm_unpacklo_ps(z(0), z(1)), _mm_unpacklo_ps(z(2), z(3)));
}
inline Float4 operator+(Float4 a, Float4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline Float4 operator-(Float4 a, Float4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline Float4 operator*(Float4 a, Float4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline Float4 operator/(Float4 a, Float4 b) { return {_mm_div_ps(a.v, b.v)}; }
inline Float4 min(Float4 a, Float4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline Float4 abs(Float4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)}; }
inline Float4 max(Float4 a, Float4 b) { return {_mm_max_ps(a.v, b.v)}; }

inline Mask4 operator<=(Float4 a, Float4 b) { return {_mm_cmple_ps(a.v, b.v)}; }
inline Mask4 operator<(Float4 a, Float4 b) { return {_mm_cmplt_ps(a.v, b.v)}; }
inline Mask4 operator==(Float4 a, Float4 b) { return {_mm_cmpeq_ps(a.v, b.v)}; }
inline Mask4 operator&(Mask4 a, Mask4 b) { return {_mm_and_ps(a.v, b.v)}; }
inline Mask4 operator|(Mask4 a, Mask4 b) { return {_mm_or_ps(a.v, b.v)}; }
inline Float4 select(Mask4 m, Float4 a, Float4 b) { return {_mm_or_ps(_mm_and_ps(m.v, a.v), _mm_andnot_ps(m.v, b.v))}; }
inline unsigned bits(Mask4 m) { return static_cast<unsigned>(_mm_movemask_ps(m.v)); }

inline unsigned signs(Float4 a) { return static_cast<unsigned>(_mm_movemask_ps(a.v)); }
inline Float4 copy_sign(Float4 a, Float4 sign) {
  __m128 mask = _mm_set1_ps(-0.0f);
  return {_mm_or_ps(_mm_andnot_ps(mask, a.v), _mm_and_ps(mask, sign.v))};
}
inline float first(Float4 a) { return _mm_cvtss_f32(a.v); }
template <int kLane>
Float4 lane(Float4 a) {
  return {_mm_shuffle_ps(a.v, a.v, 0x55 * kLane)};
}

#if defined(__FMA__)
inline Float4 product_less(Float4 a, Float4 b, Float4 c) { return {_mm_fmsub_ps(a.v, b.v, c.v)}; }
#else
inline Float4 product_less(Float4 a, Float4 b, Float4 c) { return a * b - c; }
#endif

// Comparing words is faster than comparing floats.
#if defined(__SSE4_1__)
inline Float4 later(Float4 a, Float4 b) {
  return {_mm_castsi128_ps(_mm_max_epi32(_mm_castps_si128(a.v), _mm_castps_si128(b.v)))};
}
inline Float4 sooner(Float4 a, Float4 b) {
  return {_mm_castsi128_ps(_mm_min_epi32(_mm_castps_si128(a.v), _mm_castps_si128(b.v)))};
}
#else
inline Float4 later(Float4 a, Float4 b) { return max(a, b); }
inline Float4 sooner(Float4 a, Float4 b) { return min(a, b); }
#endif
inline Mask4 is_later(Float4 a, Float4 b) {
  return {_mm_castsi128_ps(_mm_cmpgt_epi32(_mm_castps_si128(a.v), _mm_castps_si128(b.v)))};
}
inline std::uint32_t word_outside(Mask4 m, const std::uint32_t* words) {
  __m128i w = _mm_andnot_si128(_mm_castps_si128(m.v), _mm_load_si128(reinterpret_cast<const __m128i*>(words)));
  w = _mm_or_si128(w, _mm_shuffle_epi32(w, 0x4E));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_or_si128(w, _mm_shuffle_epi32(w, 0xB1))));
}

// Smallest and largest lane.
inline float lowest(Float4 a) {
  __m128 b = _mm_min_ps(a.v, _mm_movehl_ps(a.v, a.v));
  return _mm_cvtss_f32(_mm_min_ss(b, _mm_shuffle_ps(b, b, 1)));
}
inline float highest(Float4 a) {
  __m128 b = _mm_max_ps(a.v, _mm_movehl_ps(a.v, a.v));
  return _mm_cvtss_f32(_mm_max_ss(b, _mm_shuffle_ps(b, b, 1)));
}

struct Double4 {
  __m128d low, high;
  static Double4 splat(double x) { return {_mm_set1_pd(x), _mm_set1_pd(x)}; }
};
inline Double4 widen(Float4 a) { return {_mm_cvtps_pd(a.v), _mm_cvtps_pd(_mm_movehl_ps(a.v, a.v))}; }
inline Double4 operator+(Double4 a, Double4 b) { return {_mm_add_pd(a.low, b.low), _mm_add_pd(a.high, b.high)}; }
inline Double4 operator-(Double4 a, Double4 b) { return {_mm_sub_pd(a.low, b.low), _mm_sub_pd(a.high, b.high)}; }
inline Double4 operator*(Double4 a, Double4 b) { return {_mm_mul_pd(a.low, b.low), _mm_mul_pd(a.high, b.high)}; }

inline Double4 operator/(Double4 a, Double4 b) { return {_mm_div_pd(a.low, b.low), _mm_div_pd(a.high, b.high)}; }
inline Double4 min(Double4 a, Double4 b) { return {_mm_min_pd(a.low, b.low), _mm_min_pd(a.high, b.high)}; }
inline Double4 max(Double4 a, Double4 b) { return {_mm_max_pd(a.low, b.low), _mm_max_pd(a.high, b.high)}; }
inline Float4 narrow(Double4 a) { return {_mm_movelh_ps(_mm_cvtpd_ps(a.low), _mm_cvtpd_ps(a.high))}; }

struct DoubleMask4 {
  __m128d low, high;
};
inline DoubleMask4 operator<=(Double4 a, Double4 b) {
  return {_mm_cmple_pd(a.low, b.low), _mm_cmple_pd(a.high, b.high)};
}
inline DoubleMask4 operator<(Double4 a, Double4 b) {
  return {_mm_cmplt_pd(a.low, b.low), _mm_cmplt_pd(a.high, b.high)};
}
inline DoubleMask4 operator&(DoubleMask4 a, DoubleMask4 b) {
  return {_mm_and_pd(a.low, b.low), _mm_and_pd(a.high, b.high)};
}
inline DoubleMask4 operator|(DoubleMask4 a, DoubleMask4 b) {
  return {_mm_or_pd(a.low, b.low), _mm_or_pd(a.high, b.high)};
}
inline Double4 select(DoubleMask4 m, Double4 a, Double4 b) {
  return {_mm_or_pd(_mm_and_pd(m.low, a.low), _mm_andnot_pd(m.low, b.low)),
          _mm_or_pd(_mm_and_pd(m.high, a.high), _mm_andnot_pd(m.high, b.high))};
}
inline unsigned bits(DoubleMask4 m) {
  return static_cast<unsigned>(_mm_movemask_pd(m.low) | _mm_movemask_pd(m.high) << 2);
}

}  // namespace pocketray
