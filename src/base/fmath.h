// Transcendental functions in IEEE double arithmetic, without libm: the same bits everywhere. Each states its error
// bound, measured against the C library by tests/base/fmath_test.cpp. Angles are in radians.
#pragma once
#include <cstdint>
#include <cstring>

namespace pocketray {

constexpr double kPi = 3.14159265358979323846;
constexpr float kPiF = 3.14159265f;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }

double det_sin(double x);   // |error| ≤ 3e-16 for |x| ≤ 1e5, growing to 1e-7 at 1e9; the value stays in [-1, 1]
double det_cos(double x);   // as for det_sin
double det_acos(double x);  // |error| ≤ 7e-16, relative error ≤ 4e-16 near 1; x is clamped to [-1, 1]
double det_exp(double x);   // relative error ≤ 4e-16; 0 below -700, +Inf above 709
double det_log(double x);   // relative error ≤ 7e-16; -Inf at 0, NaN below

// x^y for x ≥ 0, rounded to float: relative error ≤ 6e-8, exceeding half an ulp by less than 1 %. x^0 = 1, even for
// NaN; x < 0 gives NaN.
float det_pow(float x, float y);

// Next float above x if `direction` is positive, below x if it is negative. NaN, and the infinity in that direction,
// stay.
inline float next_float_towards(float x, float direction) {
  std::uint32_t word;
  std::memcpy(&word, &x, sizeof word);
  const std::uint32_t magnitude = word & 0x7FFFFFFFu, infinity = 0x7F800000u;
  const bool up = direction > 0, positive = word == magnitude;
  if (magnitude > infinity || (magnitude == infinity && up == positive)) return x;
  if (magnitude == 0)
    word = up ? 1 : 0x80000001u;
  else
    word += up == positive ? 1u : ~0u;
  std::memcpy(&x, &word, sizeof x);
  return x;
}

}  // namespace pocketray
