// Four floats side by side: SSE2 on x86-64, NEON on aarch64, plain scalars elsewhere. Every operation rounds as IEEE
// says and none is fused, so all three give the same bits. NEON of 32-bit ARM flushes denormals and is left out for
// that.
#pragma once
#if defined(__SSE2__)
#include <emmintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace pocketray {

// min and max return the second operand where the operands are equal or not ordered; masks have one bit per lane.
#if defined(__SSE2__)

struct Float4 {
  __m128 v;
};
inline Float4 splat(float x) { return {_mm_set1_ps(x)}; }
inline Float4 load(const float* p) { return {_mm_load_ps(p)}; }
inline void store(float* p, Float4 a) { _mm_store_ps(p, a.v); }
inline Float4 operator+(Float4 a, Float4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline Float4 operator-(Float4 a, Float4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline Float4 operator*(Float4 a, Float4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline Float4 min(Float4 a, Float4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline Float4 max(Float4 a, Float4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline unsigned less_equal(Float4 a, Float4 b) {
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(a.v, b.v)));
}

#elif defined(__aarch64__)

struct Float4 {
  float32x4_t v;
};
inline Float4 splat(float x) { return {vdupq_n_f32(x)}; }
inline Float4 load(const float* p) { return {vld1q_f32(p)}; }
inline void store(float* p, Float4 a) { vst1q_f32(p, a.v); }
inline Float4 operator+(Float4 a, Float4 b) { return {vaddq_f32(a.v, b.v)}; }
inline Float4 operator-(Float4 a, Float4 b) { return {vsubq_f32(a.v, b.v)}; }
inline Float4 operator*(Float4 a, Float4 b) { return {vmulq_f32(a.v, b.v)}; }
inline Float4 min(Float4 a, Float4 b) { return {vbslq_f32(vcltq_f32(a.v, b.v), a.v, b.v)}; }
inline Float4 max(Float4 a, Float4 b) { return {vbslq_f32(vcgtq_f32(a.v, b.v), a.v, b.v)}; }
inline unsigned less_equal(Float4 a, Float4 b) {
  const uint32_t weights[4] = {1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(vcleq_f32(a.v, b.v), vld1q_u32(weights)));
}

#else

struct Float4 {
  float v[4];
};
inline Float4 splat(float x) { return {{x, x, x, x}}; }
inline Float4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
inline void store(float* p, Float4 a) {
  for (int i = 0; i < 4; ++i) p[i] = a.v[i];
}
template <class Operation>
inline Float4 map_lanes(Float4 a, Float4 b, Operation operation) {
  Float4 r;
  for (int i = 0; i < 4; ++i) r.v[i] = operation(a.v[i], b.v[i]);
  return r;
}
inline Float4 operator+(Float4 a, Float4 b) {
  return map_lanes(a, b, [](float x, float y) { return x + y; });
}
inline Float4 operator-(Float4 a, Float4 b) {
  return map_lanes(a, b, [](float x, float y) { return x - y; });
}
inline Float4 operator*(Float4 a, Float4 b) {
  return map_lanes(a, b, [](float x, float y) { return x * y; });
}
inline Float4 min(Float4 a, Float4 b) {
  return map_lanes(a, b, [](float x, float y) { return x < y ? x : y; });
}
inline Float4 max(Float4 a, Float4 b) {
  return map_lanes(a, b, [](float x, float y) { return x > y ? x : y; });
}
inline unsigned less_equal(Float4 a, Float4 b) {
  unsigned mask = 0;
  for (unsigned i = 0; i < 4; ++i) mask |= static_cast<unsigned>(a.v[i] <= b.v[i]) << i;
  return mask;
}

#endif

}  // namespace pocketray
