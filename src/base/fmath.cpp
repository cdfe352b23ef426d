#include "base/fmath.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/float_bits.h"

namespace pocketray {
namespace {

constexpr double kLn2High = 6.93147180369123816490e-01,
                 kLn2Low = 1.90821492927058770002e-10;  // Cody–Waite halves of ln 2
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
                                 s * (1.0 / 362880 + s * (-1.0 / 39916800 +
                                                          s * (1.0 / 6227020800.0 + s * (-1.0 / 1307674368000.0))))))));
}
double cos_series(double x) {
  double s = x * x;
  return 1 + s * (-1.0 / 2 +
                  s * (1.0 / 24 +
                       s * (-1.0 / 720 +
                            s * (1.0 / 40320 + s * (-1.0 / 3628800 +
                                                    s * (1.0 / 479001600.0 + s * (-1.0 / 87178291200.0 +
                                                                                  s * (1.0 / 20922789888000.0))))))));
}

// sin(x + quadrant·π/2)
double sin_quadrant(double x, int quadrant) {
  if (!std::isfinite(x)) return std::numeric_limits<double>::quiet_NaN();
  if (std::fabs(x) > 1e9)
    x = std::fmod(x, 2 * kPi);  // exact; makes the turns fit their integer (accuracy: see fmath.h)
  double turns = std::floor(x * (2 / kPi) + 0.5);
  double rest = (x - turns * kPiHalfHigh) - turns * kPiHalfLow;
  int q = static_cast<int>(static_cast<std::int64_t>(turns) + quadrant) & 3;
  double value = q & 1 ? cos_series(rest) : sin_series(rest);
  return q & 2 ? -value : value;
}

// asin(s) for 0 ≤ s ≤ 1/2: s + s³·P(s²), P a Chebyshev fit of (asin(s) − s)/s³ with error 2.4e-16.
double asin_series(double s) {
  constexpr double c[] = {
      0.028169218060881414, -0.010749050339697808, 0.01603551434914882,  0.0078029494773533175,
      0.011875494382636922, 0.013929652902326633,  0.017355259955786323, 0.02237204763174451,
      0.03038194736709848,  0.044642857103423646,  0.07500000000020764,  0.1666666666666665,
  };
  double z = s * s, p = c[0];
  for (int i = 1; i < 12; ++i) p = p * z + c[i];
  return s + s * (z * p);
}

// 2^(i/32)
constexpr double kExp2Table[32] = {
    1.0,
    1.0218971486541166,
    1.0442737824274138,
    1.0671404006768237,
    1.0905077326652577,
    1.1143867425958924,
    1.1387886347566916,
    1.1637248587775775,
    1.189207115002721,
    1.215247359980469,
    1.241857812073484,
    1.2690509571917332,
    1.2968395546510096,
    1.3252366431597413,
    1.3542555469368927,
    1.383909881963832,
    1.4142135623730951,
    1.4451808069770467,
    1.4768261459394993,
    1.5091644275934228,
    1.5422108254079407,
    1.5759808451078865,
    1.6104903319492543,
    1.645755478153965,
    1.681792830507429,
    1.718619298122478,
    1.7562521603732995,
    1.7947090750031072,
    1.8340080864093424,
    1.8741676341103,
    1.9152065613971474,
    1.9571441241754002,
};

// 2^(k/32) for −1022 ≤ k/32 < 1024
double exp2_32nds(int k) {
  int i = k & 31;
  return kExp2Table[i] * from_bits(static_cast<std::uint64_t>((k - i) / 32 + 1023) << 52);
}

// Sixteen intervals of the significand around 1. Each holds log2(c) for a point c inside it and 1/c, cut to 15 fraction
// bits so that z · (1/c) is exact for a float z. The interval around 1 has c = 1, for accuracy there.
struct LogEntry {
  double reciprocal, log2;
};
// Bits of the least significand, 0.699: keeps 1 away from an interval's end.
constexpr std::uint32_t kLogOffset = 0x3F330000;
constexpr LogEntry kLogTable[16] = {
    {1.398895263671875, -0.48428795089607085}, {1.340301513671875, -0.42255758527085646},
    {1.28643798828125, -0.3633819147822816},   {1.236724853515625, -0.30652456529226624},
    {1.190704345703125, -0.251815233572486},   {1.147979736328125, -0.19909717637166807},
    {1.10821533203125, -0.148238231811644},    {1.071136474609375, -0.09914230707095233},
    {1.03643798828125, -0.051633800310858485}, {1.0, 0.0},
    {0.948150634765625, 0.07681181343747337},  {0.895111083984375, 0.15986136181912347},
    {0.847686767578125, 0.23839682814483018},  {0.805023193359375, 0.3128977458681462},
    {0.7664794921875, 0.3836809030231347},     {0.731414794921875, 0.45123828534707344},
};

// log2 of a finite x > 0, relative error below 3e-12: x = 2^k · z, log2 x = k + log2 c + log2(1 + r), r = z/c − 1.
double log2_float(float x) {
  int k = 0;
  if (x < std::numeric_limits<float>::min()) x *= 0x1p23f, k = -23;
  std::uint32_t bits = float_bits(x), above = bits - kLogOffset;
  int exponent = static_cast<int>(above & 0xFF800000u) / (1 << 23);
  std::uint32_t z_bits = bits - (above & 0xFF800000u);
  float z;
  std::memcpy(&z, &z_bits, sizeof z);
  const LogEntry& entry = kLogTable[above >> 19 & 15];
  double r = z * entry.reciprocal - 1;          // |r| < 0.03: r^8/8 < 9e-14
  constexpr double c = 1.44269504088896340736;  // 1 / ln 2
  double p = c + r * (-c / 2 + r * (c / 3 + r * (-c / 4 + r * (c / 5 + r * (-c / 6 + r * (c / 7))))));
  return (k + exponent + entry.log2) + r * p;
}

}  // namespace

double det_sin(double x) { return sin_quadrant(x, 0); }
double det_cos(double x) { return sin_quadrant(x, 1); }

double det_acos(double x) {
  if (x != x) return x;
  if (x > 1) x = 1;
  if (x < -1) x = -1;
  double a = std::fabs(x);
  if (a <= 0.5) {
    double asin = asin_series(a);
    return kPi / 2 - (x < 0 ? -asin : asin);
  }
  double half = 2 * asin_series(std::sqrt((1 - a) * 0.5));  // acos a = 2 asin √((1 − a)/2); 1 − a is exact
  return x < 0 ? kPi - half : half;
}

double det_exp(double x) {
  if (x != x) return x;
  if (x > 709) return std::numeric_limits<double>::infinity();
  if (x < -700) return 0;
  double k = std::floor(x * (32 / 0.693147180559945309417) + 0.5);
  double r = (x - k * (kLn2High / 32)) - k * (kLn2Low / 32);  // |r| ≤ 0.011: r^7/7! < 4e-18
  double p = 1 + r * (1 + r * (1.0 / 2 + r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120 + r * (1.0 / 720))))));
  return p * exp2_32nds(static_cast<int>(k));
}

double det_log(double x) {
  if (x != x || x < 0) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0) return -std::numeric_limits<double>::infinity();
  if (x == std::numeric_limits<double>::infinity()) return x;
  int exponent = -1023;
  if (x < std::numeric_limits<double>::min()) x *= 0x1p54, exponent -= 54;
  std::uint64_t bits = to_bits(x);
  exponent += static_cast<int>(bits >> 52);
  double mantissa = from_bits((bits & 0xFFFFFFFFFFFFFull) | 0x3FF0000000000000ull);
  if (mantissa > 1.41421356237309514547) mantissa *= 0.5, ++exponent;
  double s = (mantissa - 1) / (mantissa + 1), s2 = s * s;  // log m = 2 atanh s, |s| ≤ 0.172
  constexpr double odd[] = {1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13, 1.0 / 11,
                            1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3,  1.0};
  double sum = 0;
  for (double c : odd) sum = sum * s2 + c;
  return exponent * kLn2High + (exponent * kLn2Low + 2 * s * sum);
}

float det_pow(float x, float y) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  if (y == 0 || x == 1) return 1;
  if (!(x >= 0) || y != y) return std::numeric_limits<float>::quiet_NaN();
  if (x == 0 || x == inf) return (x == 0) == (y > 0) ? 0 : inf;
  double t = y * log2_float(x);
  if (t > 127.99999991) return inf;  // log2 of the largest float
  if (t < -150) return 0;
  double k = std::floor(t * 32 + 0.5);
  double r = (t - k * (1.0 / 32)) * 0.693147180559945309417;  // |r| ≤ 0.011: r^5/5! < 1.4e-12
  double p = 1 + r * (1 + r * (1.0 / 2 + r * (1.0 / 6 + r * (1.0 / 24))));
  return static_cast<float>(p * exp2_32nds(static_cast<int>(k)));
}

}  // namespace pocketray
