// Division, square root and comparison of floats and division of doubles in integers, rounded as IEEE prescribes: for
// CPUs without floating point, a fraction of the instructions of the compiler's and the C library's own. Numbers are
// passed as bits. soft_float_arm.cpp substitutes them for those; the tests compare them with the hardware of other
// CPUs.
#pragma once
#include <cstdint>

// Defined where floats are software, whatever the architecture.
#if defined(__SOFTFP__) || defined(__mips_soft_float)
#define POCKETRAY_HAS_NO_FPU
#endif

namespace pocketray {

inline std::uint32_t high_product(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint32_t>(static_cast<std::uint64_t>(a) * b >> 32);
}

struct SoftTables {
  std::uint8_t reciprocal[128];  // 256/(1 + (i + 1)/128) − 128, rounded down
  std::uint8_t root[96];         // 256/√((i + 33)/32) − 1, rounded down: inverse roots of 1 to 4, for 1 + i/32
};
constexpr SoftTables make_soft_tables() {
  SoftTables t = {};
  for (unsigned i = 0; i < 128; ++i) t.reciprocal[i] = static_cast<std::uint8_t>(256 * 128 / (129 + i) - 128);
  for (unsigned i = 0; i < 96; ++i) {
    unsigned root = 255;
    while (root * root * (33 + i) > 256 * 256 * 32) --root;
    t.root[i] = static_cast<std::uint8_t>(root);
  }
  return t;
}
constexpr SoftTables kSoftTables = make_soft_tables();

// a/b. Returns false, and no result, unless operands and result are normal numbers.
inline bool soft_divide(std::uint32_t a, std::uint32_t b, std::uint32_t* result) {
  std::uint32_t exponent_a = a >> 23 & 255, exponent_b = b >> 23 & 255;
  if (exponent_a - 1 >= 254 || exponent_b - 1 >= 254) return false;
  std::uint32_t m = (a & 0x7FFFFF) | 0x800000, d = (b & 0x7FFFFF) | 0x800000;
  // Newton's iteration for r ≈ 2^31/D from below, D = d/2^24 in [½, 1); e is the relative error, below 2^-6 at first.
  std::uint32_t divisor = d << 8, r = (128u + kSoftTables.reciprocal[d >> 16 & 127]) << 24;
  for (int i = 0; i < 2; ++i) {
    std::uint32_t e = (1u << 31) - high_product(divisor, r);
    r += high_product(r, e) << 1;
  }
  // A quotient of 25 bits, the last one for rounding.
  bool less = m < d;
  std::int32_t exponent = static_cast<std::int32_t>(exponent_a - exponent_b) + 127 - less;
  if (exponent < 1 || exponent > 254) return false;
  std::uint32_t q = high_product(m << 8, r) >> (less ? 6 : 7);
  std::int32_t rest = static_cast<std::int32_t>((m << (24 + less)) - q * d), divided = static_cast<std::int32_t>(d);
  for (; rest < 0; --q) rest += divided;
  for (; rest >= divided; ++q) rest -= divided;
  std::uint32_t rounded = (q >> 1) + (q & ((q >> 1 & 1) | (rest != 0)));
  *result = ((a ^ b) & 1u << 31) + (static_cast<std::uint32_t>(exponent - 1) << 23) + rounded;
  return true;
}

// a/b of doubles. Returns false, and no result, unless operands and result are normal numbers.
inline bool soft_divide(std::uint64_t a, std::uint64_t b, std::uint64_t* result) {
  constexpr std::uint64_t kOne = std::uint64_t{1} << 52;
  std::uint32_t exponent_a = static_cast<std::uint32_t>(a >> 52) & 2047;
  std::uint32_t exponent_b = static_cast<std::uint32_t>(b >> 52) & 2047;
  if (exponent_a - 1 >= 2046 || exponent_b - 1 >= 2046) return false;
  std::uint64_t m = (a & (kOne - 1)) | kOne, d = (b & (kOne - 1)) | kOne;
  bool less = m < d;
  std::int32_t exponent = static_cast<std::int32_t>(exponent_a - exponent_b) + 1023 - less;
  if (exponent < 1 || exponent > 2046) return false;
  // The reciprocal as for floats, with the upper 32 bits of the divisor and an iteration more.
  std::uint32_t divisor = static_cast<std::uint32_t>(d >> 21);
  std::uint32_t r = (128u + kSoftTables.reciprocal[divisor >> 24 & 127]) << 24;
  for (int i = 0; i < 3; ++i) {
    std::uint32_t e = (1u << 31) - high_product(divisor, r);
    r += high_product(r, e) << 1;
  }
  // A quotient of 54 bits, the last one for rounding, in two digits of 27. The rest wraps around on the way.
  std::uint64_t rest = m << less, q = 0;
  std::int64_t divided = static_cast<std::int64_t>(d);
  for (int shift = 26; shift < 28; ++shift) {
    std::uint32_t digit = high_product(static_cast<std::uint32_t>(rest >> 23), r) >> (29 - shift);
    std::int64_t left = static_cast<std::int64_t>((rest << shift) - digit * d);
    for (; left < 0; --digit) left += divided;
    for (; left >= divided; ++digit) left -= divided;
    q = (q << 27) + digit, rest = static_cast<std::uint64_t>(left);
  }
  std::uint64_t rounded = (q >> 1) + (q & ((q >> 1 & 1) | (rest != 0)));
  *result = ((a ^ b) & std::uint64_t{1} << 63) + (static_cast<std::uint64_t>(exponent - 1) << 52) + rounded;
  return true;
}

// √a. Returns false unless a is a positive normal number.
inline bool soft_root(std::uint32_t a, std::uint32_t* result) {
  if (a - 0x800000 >= 0x7F000000) return false;
  std::uint32_t m = (a & 0x7FFFFF) | 0x800000, odd = ~a >> 23 & 1;  // the exponent less its bias is odd
  // Newton's iteration for y ≈ 2^32/√A from below, A = value/2^30 in [1, 4).
  std::uint32_t value = m << (7 + odd), y = static_cast<std::uint32_t>(kSoftTables.root[(value >> 25) - 32]) << 24;
  for (int i = 0; i < 2; ++i) {
    std::uint32_t e = (1u << 30) - high_product(value, high_product(y, y));  // 1 − A·y²
    y += high_product(y, e) << 1;
  }
  // A root of 25 bits, the last one for rounding.
  std::uint32_t s = high_product(value, y) >> 6;
  std::int32_t rest = static_cast<std::int32_t>((m << (25 + odd)) - s * s);
  for (; rest < 0; --s) rest += static_cast<std::int32_t>(2 * s - 1);
  for (; rest > static_cast<std::int32_t>(2 * s); ++s) rest -= static_cast<std::int32_t>(2 * s + 1);
  std::uint32_t exponent = (a >> 24) + 63 + (a >> 23 & 1);  // the floor of half of it, biased
  *result = ((exponent - 1) << 23) + (s >> 1) + (s & 1);    // never halfway
  return true;
}

inline bool soft_is_nan(std::uint32_t a) { return a << 1 > 0xFF000000u; }
// a < b for numbers: −0 equals 0.
inline bool soft_less(std::uint32_t a, std::uint32_t b) {
  if (static_cast<std::int32_t>(a & b) < 0) return a > b;
  return static_cast<std::int32_t>(a) < static_cast<std::int32_t>(b) && (a | b) << 1;
}
inline bool soft_equal(std::uint32_t a, std::uint32_t b) { return a == b || !((a | b) << 1); }

}  // namespace pocketray
