// Transcendental functions that give the same bits everywhere: IEEE double arithmetic alone, no libm. Each states its
// bound, measured by tests/base/fmath_test.cpp against the C library. Angles are radians.
#pragma once

namespace pocketray {

constexpr double kPi = 3.14159265358979323846;
constexpr float kPiF = 3.14159265f;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }

double det_sin(double x);  // |error| ≤ 3e-16 for |x| ≤ 1e5; beyond, it grows to 1e-7 at 1e9, the value stays in [-1, 1]
double det_cos(double x);   // as det_sin
double det_acos(double x);  // |error| ≤ 7e-16, relative error ≤ 4e-16 near 1; x is clamped to [-1, 1]
double det_exp(double x);   // relative error ≤ 4e-16; 0 below -700, +Inf above 709
double det_log(double x);   // relative error ≤ 7e-16; -Inf at 0, NaN below

// x^y for x ≥ 0 rounded to the nearest float: relative error ≤ 6e-8, less than one part in 100 above half an ulp. x^0 =
// 1, also for NaN; x < 0 gives NaN.
float det_pow(float x, float y);

}  // namespace pocketray
