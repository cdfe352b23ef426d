// Doubles one after the other, for CPUs without vectors of them. See simd.h.
#pragma once
#include <cstdint>

// Out of line, a lane operation costs more than it computes: GCC does not inline them all by itself.
#define POCKETRAY_INLINE __attribute__((always_inline)) inline
#define POCKETRAY_INLINE_LAMBDA __attribute__((always_inline))

namespace pocketray {

struct LaneMask4 {
  bool v[4];
};
using DoubleMask4 = LaneMask4;
struct Double4 {
  double v[4];
  static Double4 splat(double x) { return {{x, x, x, x}}; }
};

template <class Result, class A, class B, class Operation>
POCKETRAY_INLINE Result map_lanes(const A& a, const B& b, Operation operation) {
  Result r;
  for (int i = 0; i < 4; ++i) r.v[i] = operation(a.v[i], b.v[i]);
  return r;
}

// clang-format off
#define POCKETRAY_LANES(Result, A, name, expression) \
  POCKETRAY_INLINE Result name(const A& a, const A& b) { \
    return map_lanes<Result>(a, b, [](auto x, auto y) POCKETRAY_INLINE_LAMBDA { return expression; }); \
  }
POCKETRAY_LANES(Double4, Double4, operator+, x + y)
POCKETRAY_LANES(Double4, Double4, operator-, x - y)
POCKETRAY_LANES(Double4, Double4, operator*, x * y)
POCKETRAY_LANES(Double4, Double4, operator/, x / y)
POCKETRAY_LANES(Double4, Double4, min, x < y ? x : y)
POCKETRAY_LANES(Double4, Double4, max, x > y ? x : y)
POCKETRAY_LANES(LaneMask4, Double4, operator<=, x <= y)
POCKETRAY_LANES(LaneMask4, Double4, operator<, x < y)
POCKETRAY_LANES(LaneMask4, LaneMask4, operator&, x && y)
POCKETRAY_LANES(LaneMask4, LaneMask4, operator|, x || y)
// clang-format on

template <class Value>
POCKETRAY_INLINE Value select(const LaneMask4& m, const Value& a, const Value& b) {
  Value r;
  for (int i = 0; i < 4; ++i) r.v[i] = m.v[i] ? a.v[i] : b.v[i];
  return r;
}
POCKETRAY_INLINE unsigned bits(const LaneMask4& m) {
  unsigned r = 0;
  for (int i = 0; i < 4; ++i) r |= static_cast<unsigned>(m.v[i]) << i;
  return r;
}

}  // namespace pocketray
