#include "base/fmath.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace pocketray {
namespace {

constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;  // Cody–Waite halves of ln 2
constexpr double kPiHalfHigh = 1.57079632673412561417e+00, kPiHalfLow = 6.07710050650619224932e-11;

double from_bits(std::uint64_t bits) {
  double x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
std::uint64_t to_bits(double x) {
  std::uint64_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}

// Taylor series on |x| ≤ π/4: the first omitted term is below 1e-17.
double sin_series(double x) {
  double s = x * x;
  return x * (1 + s * (-1.0 / 6 +
                       s * (1.0 / 120 +
                            s * (-1.0 / 5040 +
                                 s * (1.0 / 362880 +
                                      s * (-1.0 / 39916800 + s * (1.0 / 6227020800.0 + s * (-1.0 / 1307674368000.0))))))));
}
double cos_series(double x) {
  double s = x * x;
  return 1 + s * (-1.0 / 2 +
                  s * (1.0 / 24 +
                       s * (-1.0 / 720 +
                            s * (1.0 / 40320 +
                                 s * (-1.0 / 3628800 +
                                      s * (1.0 / 479001600.0 + s * (-1.0 / 87178291200.0 + s * (1.0 / 20922789888000.0))))))));
}

// sin(x + quadrant·π/2)
double sin_quadrant(double x, int quadrant) {
  if (!std::isfinite(x)) return std::numeric_limits<double>::quiet_NaN();
  double turns = std::floor(x * (2 / kPi) + 0.5);
  double rest = (x - turns * kPiHalfHigh) - turns * kPiHalfLow;
  int q = static_cast<int>(static_cast<std::int64_t>(turns) + quadrant) & 3;
  double value = q & 1 ? cos_series(rest) : sin_series(rest);
  return q & 2 ? -value : value;
}

}  // namespace

double det_sin(double x) { return sin_quadrant(x, 0); }
double det_cos(double x) { return sin_quadrant(x, 1); }

double det_acos(double x) {
  if (x != x) return x;
  if (x > 1) x = 1;
  if (x < -1) x = -1;
  // Bisection-free: start from the polynomial of [Abramowitz & Stegun 4.4.45], polish by Newton on cos.
  double a = std::fabs(x);
  double y = std::sqrt(1 - a) * (1.5707288 + a * (-0.2121144 + a * (0.0742610 - 0.0187293 * a)));
  for (int i = 0; i < 2; ++i) {
    double s = det_sin(y);
    if (s > 1e-4) y += (det_cos(y) - a) / s;
  }
  return x < 0 ? kPi - y : y;
}

double det_exp(double x) {
  if (x != x) return x;
  if (x > 709) return std::numeric_limits<double>::infinity();
  if (x < -700) return 0;
  double k = std::floor(x * (1 / 0.693147180559945309417) + 0.5);
  double r = (x - k * kLn2High) - k * kLn2Low;
  double sum = 1;
  for (int n = 13; n >= 1; --n) sum = 1 + r * sum / n;  // |r| ≤ 0.35: r^14/14! < 5e-18
  return sum * from_bits(static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023) << 52);
}

double det_log(double x) {
  if (x != x || x < 0) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0) return -std::numeric_limits<double>::infinity();
  if (x == std::numeric_limits<double>::infinity()) return x;
  std::uint64_t bits = to_bits(x);
  int exponent = static_cast<int>(bits >> 52) - 1023;
  double mantissa = from_bits((bits & 0xFFFFFFFFFFFFFull) | 0x3FF0000000000000ull);
  if (mantissa > 1.41421356237309514547) mantissa *= 0.5, ++exponent;
  double s = (mantissa - 1) / (mantissa + 1), s2 = s * s;  // log m = 2 atanh s, |s| ≤ 0.172
  double sum = 0;
  for (int n = 21; n >= 1; n -= 2) sum = sum * s2 + 1.0 / n;
  return exponent * kLn2High + (exponent * kLn2Low + 2 * s * sum);
}

float det_pow(float x, float y) {
  if (y == 0) return 1;
  if (x == 0) return y > 0 ? 0 : std::numeric_limits<float>::infinity();
  if (x == 1) return 1;
  return static_cast<float>(det_exp(static_cast<double>(y) * det_log(x)));
}

}  // namespace pocketray
