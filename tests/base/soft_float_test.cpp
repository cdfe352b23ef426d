// Arithmetic in integers gives the bits of the hardware.
#include "base/soft_float.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "base/rng.h"

using namespace pocketray;

namespace {

float value_of(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}
std::uint32_t bits_of(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
bool is_normal(std::uint32_t bits) { return std::isnormal(value_of(bits)); }

// Zeros, ones, the ends of the normal and denormal numbers, infinity, NaN, significands of few and of many ones.
constexpr std::uint32_t kSpecial[] = {0,          1,          2,          0x7FFFFF,   0x800000,   0x800001,
                                      0xFFFFFF,   0x3F7FFFFF, 0x3F800000, 0x3F800001, 0x3FC00000, 0x3FFFFFFF,
                                      0x40000000, 0x40490FDB, 0x4B7FFFFF, 0x4B800000, 0x7E7FFFFF, 0x7F7FFFFE,
                                      0x7F7FFFFF, 0x7F800000, 0x7F800001, 0x7FC00000, 0x7FFFFFFF, 0x3EAAAAAB,
                                      0x3F555555, 0x00400000, 0x34000000, 0x7F000000};

int wrong_pair(std::uint32_t a, std::uint32_t b, std::uint64_t* divided) {
  float x = value_of(a), y = value_of(b);
  int wrong = 0;
  std::uint32_t quotient, expected = bits_of(x / y);
  if (soft_divide(a, b, &quotient))
    ++*divided, wrong += quotient != expected;
  else
    wrong += is_normal(a) && is_normal(b) && is_normal(expected) && (expected << 1) > 0x01000000;
  bool numbers = !soft_is_nan(a) && !soft_is_nan(b);
  wrong += numbers != !std::isunordered(x, y);
  if (numbers) wrong += soft_less(a, b) != (x < y), wrong += soft_equal(a, b) != (x == y);
  return wrong;
}

// POCKETRAY_SOFT_PAIRS in the environment asks for more.
std::uint64_t pair_count() {
  const char* text = std::getenv("POCKETRAY_SOFT_PAIRS");
  return text ? std::strtoull(text, nullptr, 10) : 2000000;
}

}  // namespace

// Goal: quotients and comparisons are the hardware's. Method: all pairs of special values and their neighbours, of both
// signs; random pairs, half of them with exponents close together.
TEST_CASE("soft_float_quotients_and_comparisons_are_the_hardwares") {
  std::uint64_t wrong = 0, divided = 0, count = pair_count();
  for (std::uint32_t a : kSpecial)
    for (std::uint32_t b : kSpecial)
      for (unsigned signs = 0; signs < 4; ++signs)
        for (std::uint32_t da = 0; da < 5; ++da)
          for (std::uint32_t db = 0; db < 5; ++db)
            wrong += static_cast<std::uint64_t>(
                wrong_pair((a + da - 2) ^ (signs & 1) << 31, (b + db - 2) ^ (signs >> 1) << 31, &divided));
  CHECK(divided > 1000);
  Rng rng = make_rng(511);
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint32_t a = next_u32(&rng), b = next_u32(&rng);
    if (i & 1) b = (b & 0x83FFFFFF) | (a & 0x7C000000);
    wrong += static_cast<std::uint64_t>(wrong_pair(a, b, &divided));
  }
  CHECK(wrong == 0);
  CHECK(divided > count / 2);
}

// Goal: quotients of doubles are the hardware's. Method: all pairs of special values, with neighbours and signs; random
// pairs, half of them with exponents close together, some with few bits; products of one factor, which divide evenly.
TEST_CASE("soft_float_quotients_of_doubles_are_the_hardwares") {
  std::uint64_t wrong = 0, divided = 0, count = pair_count();
  auto compare = [&](std::uint64_t a, std::uint64_t b) {
    double x, y;
    std::memcpy(&x, &a, sizeof x), std::memcpy(&y, &b, sizeof y);
    double expected = x / y;
    std::uint64_t quotient, bits;
    std::memcpy(&bits, &expected, sizeof bits);
    if (soft_divide(a, b, &quotient))
      ++divided, wrong += quotient != bits;
    else
      wrong += std::isnormal(x) && std::isnormal(y) && std::isnormal(expected) && (bits << 1) > std::uint64_t{1} << 54;
  };
  std::uint64_t special[2 * std::size(kSpecial)];
  for (std::size_t i = 0; i < std::size(kSpecial); ++i) {
    // The pattern's exponent and significand at either end of a double's, the rest filled with its last bit.
    std::uint64_t wide = kSpecial[i], sign_kept = wide & 1 ? (std::uint64_t{1} << 29) - 1 : 0;
    special[2 * i] = (wide + (wide >= 0x800000 ? 896u << 23 : 0)) << 29 | sign_kept;
    special[2 * i + 1] = wide << 32 | (wide & 1 ? 0xFFFFFFFF : 0);
  }
  for (std::uint64_t a : special)
    for (std::uint64_t b : special)
      for (unsigned signs = 0; signs < 4; ++signs)
        for (std::uint64_t da = 0; da < 5; ++da)
          for (std::uint64_t db = 0; db < 5; ++db)
            compare((a + da - 2) ^ std::uint64_t{signs & 1} << 63, (b + db - 2) ^ std::uint64_t{signs >> 1} << 63);
  CHECK(divided > 10000);
  Rng rng = make_rng(512);
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t a = std::uint64_t{next_u32(&rng)} << 32 | next_u32(&rng);
    std::uint64_t b = std::uint64_t{next_u32(&rng)} << 32 | next_u32(&rng);
    if (i & 1) b = (b & ~(std::uint64_t{0x7F8} << 52)) | (a & std::uint64_t{0x7F8} << 52);
    if (i % 8 == 3) b &= ~std::uint64_t{0} << next_u32(&rng) % 53;
    compare(a, b);
    double factor = 1 + next_u32(&rng), product = factor * (1 + (next_u32(&rng) >> 11));
    std::memcpy(&a, &product, sizeof a), std::memcpy(&b, &factor, sizeof b);
    compare(a, b), compare(a + 1, b), compare(a - 1, b);
  }
  CHECK(wrong == 0);
  CHECK(divided > 3 * count);
}

// Goal: roots are the hardware's. Method: every significand with an even and an odd exponent, some with others; special
// values.
TEST_CASE("soft_float_roots_are_the_hardwares") {
  int wrong = 0;
  for (std::uint32_t a : kSpecial)
    for (std::uint32_t sign : {0u, 1u << 31}) {
      std::uint32_t root;
      bool found = soft_root(a ^ sign, &root);
      wrong += found != (is_normal(a) && !sign) || (found && root != bits_of(std::sqrt(value_of(a))));
    }
  for (std::uint32_t m = 0; m < 1u << 24; ++m) {
    std::uint32_t a = 0x3F000000 + m, other = (m & 0xFFFFFF) + ((m % 126) << 24), root = 0;
    wrong += !soft_root(a, &root) || root != bits_of(std::sqrt(value_of(a)));
    if (other >= 0x800000) wrong += !soft_root(other, &root) || root != bits_of(std::sqrt(value_of(other)));
  }
  CHECK(wrong == 0);
}
