// Lanes one after the other, for CPUs without a vector unit that keeps to IEEE. See simd.h.
#pragma once

namespace pocketray {

struct Mask4 {
  bool v[4];
};
struct Float4 {
  float v[4];
  static constexpr int kLanes = 4;
  static Float4 splat(float x) { return {{x, x, x, x}}; }
  static Float4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
  static Float4 repeat(Float4 a) { return a; }
  static Float4 spread(const float* p) { return splat(*p); }
  static Mask4 mask_of(unsigned bits) { return {{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0}}; }
};
struct Double4 {
  double v[4];
  static Double4 splat(double x) { return {{x, x, x, x}}; }
};

template <class Result, class A, class B, class Operation>
inline Result map_lanes(const A& a, const B& b, Operation operation) {
  Result r;
  for (int i = 0; i < 4; ++i) r.v[i] = operation(a.v[i], b.v[i]);
  return r;
}

// clang-format off
#define POCKETRAY_LANES(Result, A, name, expression) \
  inline Result name(const A& a, const A& b) { \
    return map_lanes<Result>(a, b, [](auto x, auto y) { return expression; }); \
  }
POCKETRAY_LANES(Float4, Float4, operator+, x + y)
POCKETRAY_LANES(Float4, Float4, operator-, x - y)
POCKETRAY_LANES(Float4, Float4, operator*, x * y)
POCKETRAY_LANES(Float4, Float4, operator/, x / y)
POCKETRAY_LANES(Float4, Float4, min, x < y ? x : y)
POCKETRAY_LANES(Float4, Float4, max, x > y ? x : y)
POCKETRAY_LANES(Mask4, Float4, operator<=, x <= y)
POCKETRAY_LANES(Mask4, Float4, operator<, x < y)
POCKETRAY_LANES(Mask4, Float4, operator==, x == y)
POCKETRAY_LANES(Double4, Double4, operator+, x + y)
POCKETRAY_LANES(Double4, Double4, operator-, x - y)
POCKETRAY_LANES(Double4, Double4, operator*, x * y)
POCKETRAY_LANES(Double4, Double4, operator/, x / y)
POCKETRAY_LANES(Double4, Double4, min, x < y ? x : y)
POCKETRAY_LANES(Double4, Double4, max, x > y ? x : y)
POCKETRAY_LANES(Mask4, Double4, operator<=, x <= y)
POCKETRAY_LANES(Mask4, Double4, operator<, x < y)
POCKETRAY_LANES(Mask4, Mask4, operator&, x && y)
POCKETRAY_LANES(Mask4, Mask4, operator|, x || y)
#undef POCKETRAY_LANES
// clang-format on

inline Float4 abs(const Float4& a) {
  return map_lanes<Float4>(a, a, [](float x, float) { return __builtin_fabsf(x); });
}
template <class Value>
inline Value select(const Mask4& m, const Value& a, const Value& b) {
  Value r;
  for (int i = 0; i < 4; ++i) r.v[i] = m.v[i] ? a.v[i] : b.v[i];
  return r;
}
inline unsigned bits(const Mask4& m) {
  unsigned r = 0;
  for (int i = 0; i < 4; ++i) r |= static_cast<unsigned>(m.v[i]) << i;
  return r;
}
inline float lowest(const Float4& a) {
  float r = a.v[0];
  for (int i = 1; i < 4; ++i) r = a.v[i] < r ? a.v[i] : r;
  return r;
}
inline float highest(const Float4& a) {
  float r = a.v[0];
  for (int i = 1; i < 4; ++i) r = a.v[i] > r ? a.v[i] : r;
  return r;
}
inline void store(float* p, const Float4& a) {
  for (int i = 0; i < 4; ++i) p[i] = a.v[i];
}
inline Double4 widen(const Float4& a) { return {{a.v[0], a.v[1], a.v[2], a.v[3]}}; }
inline Float4 narrow(const Double4& a) {
  Float4 r;
  for (int i = 0; i < 4; ++i) r.v[i] = static_cast<float>(a.v[i]);
  return r;
}

// Two doubles.
struct DoubleMask2 {
  bool v[2];
};
struct Double2 {
  double v[2];
  static Double2 splat(double x) { return {{x, x}}; }
  static Double2 widen(const float* p) { return {{p[0], p[1]}}; }
};
inline void store(double* p, const Double2& a) { p[0] = a.v[0], p[1] = a.v[1]; }
// clang-format off
#define POCKETRAY_PAIRS(Result, A, name, first, second) \
  inline Result name(const A& a, const A& b) { return {{first, second}}; }
POCKETRAY_PAIRS(Double2, Double2, operator+, a.v[0] + b.v[0], a.v[1] + b.v[1])
POCKETRAY_PAIRS(Double2, Double2, operator-, a.v[0] - b.v[0], a.v[1] - b.v[1])
POCKETRAY_PAIRS(Double2, Double2, operator*, a.v[0] * b.v[0], a.v[1] * b.v[1])
POCKETRAY_PAIRS(Double2, Double2, operator/, a.v[0] / b.v[0], a.v[1] / b.v[1])
POCKETRAY_PAIRS(Double2, Double2, min, a.v[0] < b.v[0] ? a.v[0] : b.v[0], a.v[1] < b.v[1] ? a.v[1] : b.v[1])
POCKETRAY_PAIRS(Double2, Double2, max, a.v[0] > b.v[0] ? a.v[0] : b.v[0], a.v[1] > b.v[1] ? a.v[1] : b.v[1])
POCKETRAY_PAIRS(DoubleMask2, Double2, operator<=, a.v[0] <= b.v[0], a.v[1] <= b.v[1])
POCKETRAY_PAIRS(DoubleMask2, Double2, operator<, a.v[0] < b.v[0], a.v[1] < b.v[1])
POCKETRAY_PAIRS(DoubleMask2, DoubleMask2, operator&, a.v[0] && b.v[0], a.v[1] && b.v[1])
POCKETRAY_PAIRS(DoubleMask2, DoubleMask2, operator|, a.v[0] || b.v[0], a.v[1] || b.v[1])
#undef POCKETRAY_PAIRS
// clang-format on
inline Double2 select(const DoubleMask2& m, const Double2& a, const Double2& b) {
  return {{m.v[0] ? a.v[0] : b.v[0], m.v[1] ? a.v[1] : b.v[1]}};
}
inline unsigned bits(const DoubleMask2& m) {
  return static_cast<unsigned>(m.v[0]) | static_cast<unsigned>(m.v[1]) << 1;
}

template <int kLanes>
struct Lanes;
template <>
struct Lanes<4> {
  using Floats = Float4;
  using Doubles = Double4;
};

}  // namespace pocketray
