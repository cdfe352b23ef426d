// Transcendental functions in IEEE double arithmetic, without libm: the same bits everywhere. Each states its error
// bound, measured against the C library by tests/base/fmath_test.cpp. Angles are in radians.
#pragma once

namespace pocketray {

constexpr double kPi = 3.14159265358979323846;
constexpr float kPiF = 3.14159265f;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }

double det_sin(double x);   // |error| ≤ 3e-16 for |x| ≤ 1e5, growing to 1e-7 at 1e9; the value stays in [-1, 1]
double det_cos(double x);   // as det_sin
double det_acos(double x);  // |error| ≤ 7e-16, relative error ≤ 4e-16 near 1; x is clamped to [-1, 1]
double det_exp(double x);   // relative error ≤ 4e-16; 0 below -700, +Inf above 709
double det_log(double x);   // relative error ≤ 7e-16; -Inf at 0, NaN below

// x^y for x ≥ 0, rounded to float: relative error ≤ 6e-8, exceeding half an ulp by less than 1 %. x^0 = 1, even for
// NaN; x < 0 gives NaN.
float det_pow(float x, float y);

}  // namespace pocketray
