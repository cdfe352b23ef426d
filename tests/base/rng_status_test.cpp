#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <string>

#include "base/rng.h"
#include "base/status.h"

using namespace pocketray;

// Goal: this is PCG32. Method: the reference implementation's demo output for seed 42, stream 54 [O'Neill 2014].
TEST_CASE("rng_matches_the_reference_sequence") {
  Rng rng = make_rng(42, 54);
  for (std::uint32_t expected : {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
    CHECK(next_u32(&rng) == expected);
}

// Goal: floats are uniform in [0, 1), never 1. Method: chi-squared over 64 bins: with 63 degrees of freedom, 120 is
// exceeded less than once in 10^5. The largest 32-bit word must still give less than one.
TEST_CASE("rng_floats_are_uniform_below_one") {
  CHECK(static_cast<float>(0xFFFFFFFFu >> 8) * 0x1p-24f < 1.0f);
  for (std::uint64_t seed : {1, 2, 3}) {
    CAPTURE(seed);
    Rng rng = make_rng(seed);
    int bins[64] = {0}, bins_double[64] = {0};
    const int count = 64000;
    for (int i = 0; i < count; ++i) {
      float f = next_float(&rng);
      double d = next_double(&rng);
      if (!(f >= 0 && f < 1 && d >= 0 && d < 1)) FAIL("outside [0, 1) at draw ", i);
      ++bins[static_cast<int>(f * 64)], ++bins_double[static_cast<int>(d * 64)];
    }
    double chi = 0, chi_double = 0;
    for (int b = 0; b < 64; ++b) {
      chi += std::pow(bins[b] - count / 64.0, 2) / (count / 64.0);
      chi_double += std::pow(bins_double[b] - count / 64.0, 2) / (count / 64.0);
    }
    CHECK(chi < 120);
    CHECK(chi_double < 120);
  }
}

// Goal: streams and seeds differ.
TEST_CASE("rng_streams_are_distinct") {
  Rng a = make_rng(1, 0), b = make_rng(1, 1), c = make_rng(2, 0);
  int same = 0;
  for (int i = 0; i < 1000; ++i) {
    std::uint32_t x = next_u32(&a), y = next_u32(&b), z = next_u32(&c);
    same += (x == y) + (y == z) + (x == z);
  }
  CHECK(same <= 1);
}

namespace {

Status half(int x) {
  if (x % 2) return failure("%d is odd, give an even number", x);
  return success();
}
Status quarter(int x) {
  RETURN_IF_ERROR(half(x));
  RETURN_IF_ERROR(half(x / 2));
  return success();
}

}  // namespace

// Goal: the first error arrives unchanged; text that is too long is truncated, not written past the end.
TEST_CASE("status_carries_the_first_error_and_cuts_long_text") {
  CHECK(quarter(8).ok);
  CHECK(quarter(8).message[0] == 0);
  CHECK(!quarter(6).ok);
  CHECK(std::string(quarter(6).message) == "3 is odd, give an even number");
  CHECK(std::string(quarter(5).message) == "5 is odd, give an even number");
  std::string long_text(2000, 'x');
  Status cut = failure("%s", long_text.c_str());
  CHECK(!cut.ok);
  CHECK(std::string(cut.message).size() == sizeof cut.message - 1);
}
