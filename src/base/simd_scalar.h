// Lanes one after the other, for CPUs without an IEEE vector unit. See simd.h.
#pragma once
#include "base/simd_scalar_doubles.h"

namespace pocketray {

using Mask4 = LaneMask4;
struct Float4 {
  float v[4];
  static constexpr int kLanes = 4;
  static Float4 splat(float x) { return {{x, x, x, x}}; }
  static Float4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  static Float4 load3(const float* p) { return {{p[0], p[1], p[2], 0}}; }
  static Float4 repeat(Float4 a) { return a; }
  static Float4 spread(const float* p) { return splat(*p); }
  static Mask4 mask_of(unsigned bits) { return {{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0}}; }
};

// clang-format off
POCKETRAY_LANES(Float4, Float4, operator+, x + y)
POCKETRAY_LANES(Float4, Float4, operator-, x - y)
POCKETRAY_LANES(Float4, Float4, operator*, x * y)
POCKETRAY_LANES(Float4, Float4, operator/, x / y)
POCKETRAY_LANES(Float4, Float4, min, x < y ? x : y)
POCKETRAY_LANES(Float4, Float4, max, x > y ? x : y)
POCKETRAY_LANES(Float4, Float4, copy_sign, __builtin_copysignf(x, y))
POCKETRAY_LANES(Float4, Float4, later, x > y ? x : y)
POCKETRAY_LANES(Float4, Float4, sooner, x < y ? x : y)
POCKETRAY_LANES(Mask4, Float4, is_later, x > y)
POCKETRAY_LANES(Mask4, Float4, operator<=, x <= y)
POCKETRAY_LANES(Mask4, Float4, operator<, x < y)
POCKETRAY_LANES(Mask4, Float4, operator==, x == y)
#undef POCKETRAY_LANES
// clang-format on

POCKETRAY_INLINE Float4 abs(const Float4& a) {
  return map_lanes<Float4>(a, a, [](float x, float) { return __builtin_fabsf(x); });
}
POCKETRAY_INLINE Float4 product_less(const Float4& a, const Float4& b, const Float4& c) { return a * b - c; }
POCKETRAY_INLINE unsigned signs(const Float4& a) {
  unsigned r = 0;
  for (int i = 0; i < 4; ++i) r |= static_cast<unsigned>(__builtin_signbit(a.v[i]) != 0) << i;
  return r;
}
POCKETRAY_INLINE float first(const Float4& a) { return a.v[0]; }
template <int kLane>
POCKETRAY_INLINE Float4 lane(const Float4& a) {
  return Float4::splat(a.v[kLane]);
}
POCKETRAY_INLINE std::uint32_t word_outside(const Mask4& m, const std::uint32_t* words) {
  int i = 0;
  while (i < 3 && m.v[i]) ++i;
  return words[i];
}
POCKETRAY_INLINE float lowest(const Float4& a) {
  float r = a.v[0];
  for (int i = 1; i < 4; ++i) r = a.v[i] < r ? a.v[i] : r;
  return r;
}
POCKETRAY_INLINE float highest(const Float4& a) {
  float r = a.v[0];
  for (int i = 1; i < 4; ++i) r = a.v[i] > r ? a.v[i] : r;
  return r;
}
POCKETRAY_INLINE void load_points(const float* const (&p)[4], Float4 (&rows)[3]) {
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 4; ++i) rows[axis].v[i] = p[i][axis];
}
POCKETRAY_INLINE void store(float* p, const Float4& a) {
  for (int i = 0; i < 4; ++i) p[i] = a.v[i];
}
POCKETRAY_INLINE Double4 widen(const Float4& a) { return {{a.v[0], a.v[1], a.v[2], a.v[3]}}; }
POCKETRAY_INLINE Float4 narrow(const Double4& a) {
  Float4 r;
  for (int i = 0; i < 4; ++i) r.v[i] = static_cast<float>(a.v[i]);
  return r;
}

}  // namespace pocketray
