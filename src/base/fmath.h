// Transcendental functions that give the same bits everywhere: IEEE double arithmetic alone, no libm. Each states its bound,
// measured by tests/base/fmath_test.cpp against the C library. Angles are radians.
#pragma once

namespace pocketray {

constexpr double kPi = 3.14159265358979323846;
constexpr float kPiF = 3.14159265f;

constexpr double radians(double degrees) { return degrees * (kPi / 180.0); }

double det_sin(double x);   // |error| ≤ 2e-15 for |x| ≤ 1e5
double det_cos(double x);   // |error| ≤ 2e-15 for |x| ≤ 1e5
double det_acos(double x);  // |error| ≤ 2e-9; x is clamped to [-1, 1]
double det_exp(double x);   // relative error ≤ 1e-14; 0 below -700, +Inf above 709
double det_log(double x);   // |error| ≤ 1e-14·max(1, |log x|) for normal x > 0; -Inf at 0, NaN below

// x^y for x ≥ 0, rounded to float: relative error ≤ 1e-7 + 1e-14·|y·log x|. 0^0 = 1.
float det_pow(float x, float y);

}  // namespace pocketray
