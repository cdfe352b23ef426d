#include "base/fmath.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "base/rng.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfinityF = std::numeric_limits<float>::infinity();
constexpr bool kLongDoubleIsLonger = sizeof(long double) > sizeof(double);  // not on 32-bit ARM, mostly emulated
constexpr int kSampleCount = kLongDoubleIsLonger ? 200000 : 10000;

// Largest error of `ours` against the C library's long double function over random samples in [low, high]. Where long
// double is double (32-bit ARM), allows for the library's own error of up to an ulp.
double greatest_error(double (*ours)(double), long double (*exact)(long double), double low, double high,
                      bool relative) {
  Rng rng = make_rng(7);
  double worst = 0;
  for (int i = 0; i < kSampleCount; ++i) {
    double x = low + (high - low) * next_double(&rng);
    long double truth = exact(x), error = std::fabs(ours(x) - truth);
    if (!kLongDoubleIsLonger) error -= std::fabs(truth) * 0x1p-52L;
    if (error > 0 && relative) error /= std::fabs(truth);
    if (error > worst || error != error) worst = static_cast<double>(error);
  }
  return worst;
}

}  // namespace

// Goal: the bounds stated in fmath.h. Method: dense random samples against the C library in long double, seed 7.
TEST_CASE("fmath_sin_and_cos_keep_their_bounds") {
  for (double reach : {1.0, 7.0, 1e3, 1e5}) {
    CAPTURE(reach);
    CHECK(greatest_error(det_sin, sinl, -reach, reach, false) <= 3e-16);
    CHECK(greatest_error(det_cos, cosl, -reach, reach, false) <= 3e-16);
  }
  CHECK(greatest_error(det_sin, sinl, -1e9, 1e9, false) <= 1e-7);
  for (double x : {1e10, 1e19, -1e300, 1.7e308}) {
    CHECK(std::fabs(det_sin(x)) <= 1);
    CHECK(std::fabs(det_cos(x)) <= 1);
  }
  CHECK(det_sin(0) == 0);
  CHECK(det_cos(0) == 1);
  CHECK(std::isnan(det_sin(kInfinity)));
  CHECK(std::isnan(det_cos(kNan)));
}

TEST_CASE("fmath_acos_keeps_its_bounds") {
  CHECK(greatest_error(det_acos, acosl, -1, 1, false) <= 7e-16);
  CHECK(greatest_error(det_acos, acosl, 0.49, 0.51, false) <= 7e-16);
  CHECK(greatest_error(det_acos, acosl, 0.999, 1, true) <= 4e-16);
  CHECK(greatest_error(det_acos, acosl, 1 - 1e-12, 1, true) <= 4e-16);
  CHECK(det_acos(1) == 0);
  CHECK(det_acos(1.0000001) == 0);
  CHECK(det_acos(-1) == kPi);
  CHECK(det_acos(-7) == kPi);
  CHECK(std::isnan(det_acos(kNan)));
}

TEST_CASE("fmath_exp_keeps_its_bounds") {
  CHECK(greatest_error(det_exp, expl, -1, 1, true) <= 4e-16);
  CHECK(greatest_error(det_exp, expl, -700, 709, true) <= 4e-16);
  CHECK(det_exp(0) == 1);
  CHECK(det_exp(-700.5) == 0);
  CHECK(det_exp(-kInfinity) == 0);
  CHECK(det_exp(709.5) == kInfinity);
  CHECK(std::isnan(det_exp(kNan)));
}

TEST_CASE("fmath_log_keeps_its_bounds") {
  for (double high : {1e-320, 1e-300, 1e-3, 1.0, 2.0, 1e30, 1e308}) {
    CAPTURE(high);
    CHECK(greatest_error(det_log, logl, high / 3, high, true) <= 7e-16);
  }
  CHECK(greatest_error(det_log, logl, 0.9, 1.1, true) <= 7e-16);
  CHECK(greatest_error(det_log, logl, 1 - 1e-9, 1 + 1e-9, true) <= 7e-16);
  CHECK(det_log(1) == 0);
  CHECK(det_log(0) == -kInfinity);
  CHECK(det_log(kInfinity) == kInfinity);
  CHECK(std::isnan(det_log(-1)));
  CHECK(std::isnan(det_log(kNan)));
}

// Goal: det_pow's bound. Method: four families: highlights, exponents up to 10^6 near 1, all magnitudes, random bits.
TEST_CASE("fmath_pow_keeps_its_bound") {
  Rng rng = make_rng(11);
  for (int family = 0; family < 4; ++family) {
    CAPTURE(family);
    double worst = 0;
    int compared = 0;
    for (int i = 0; i < kSampleCount; ++i) {
      float a = next_float(&rng), b = next_float(&rng), x = a, y = b * 200;
      if (family == 1) x = 1 - a * 1e-4f, y = b * 1e6f;
      if (family == 2) x = std::ldexp(1 + a, static_cast<int>(next_u32(&rng) % 270) - 145), y = (b - 0.5f) * 4;
      if (family == 3) x = a * 2, y = (b - 0.5f) * 100;
      long double truth = std::pow(static_cast<long double>(x), static_cast<long double>(y));
      if (!(truth >= std::numeric_limits<float>::min() && truth <= std::numeric_limits<float>::max())) continue;
      double error = static_cast<double>(std::fabs((det_pow(x, y) - truth) / truth));
      if (error > worst || error != error) worst = error;
      ++compared;
    }
    CHECK(worst <= 6e-8);
    CHECK(compared > kSampleCount / 8);
  }
}

TEST_CASE("fmath_pow_is_defined_at_the_edges") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(det_pow(0, 0) == 1);
  CHECK(det_pow(nan, 0) == 1);
  CHECK(det_pow(1, nan) == 1);
  CHECK(det_pow(1, kInfinityF) == 1);
  CHECK(det_pow(0, 2) == 0);
  CHECK(det_pow(0, -2) == kInfinityF);
  CHECK(det_pow(kInfinityF, 2) == kInfinityF);
  CHECK(det_pow(kInfinityF, -2) == 0);
  CHECK(det_pow(0.5f, kInfinityF) == 0);
  CHECK(det_pow(2, kInfinityF) == kInfinityF);
  CHECK(det_pow(2, -kInfinityF) == 0);
  CHECK(det_pow(2, 127) == 0x1p127f);
  CHECK(det_pow(2, 128) == kInfinityF);
  CHECK(det_pow(2, -149) == 0x1p-149f);
  CHECK(det_pow(2, -151) == 0);
  CHECK(det_pow(0x1p-149f, 0.5f) == doctest::Approx(std::sqrt(0x1p-149)).epsilon(1e-7));
  CHECK(det_pow(0.999999f, 1e6f) == doctest::Approx(0.3679).epsilon(2e-2));  // HARDCASES row 31's largest exponent
  CHECK(std::isnan(det_pow(-1, 2)));
  CHECK(std::isnan(det_pow(nan, 2)));
  CHECK(std::isnan(det_pow(2, nan)));
}

// Goal: the same bits on every CPU (HARDCASES row 63). Method: FNV-1a over results; the value was recorded on x86-64,
// and armel and armhf agree.
TEST_CASE("hard_63_fmath_gives_the_same_bits_everywhere") {
  count_assertions("the same bits in every build");
  Rng rng = make_rng(13);
  std::uint64_t hash = 14695981039346656037ull;
  auto add = [&](double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    hash = (hash ^ bits) * 1099511628211ull;
  };
  for (int i = 0; i < 20000; ++i) {
    double x = next_double(&rng) * 20 - 10;
    add(det_sin(x)), add(det_cos(x * 1000)), add(det_acos(x / 10)), add(det_exp(x * 60)), add(det_log(std::fabs(x)));
    float base = next_float(&rng), exponent = next_float(&rng) * 50;
    add(det_pow(base, exponent));
  }
  CHECK(hash == 6964161225244906059u);
}

TEST_CASE("fmath_next_float_is_nextafter") {
  Rng rng = make_rng(3);
  int wrong = 0;
  auto check = [&](float x) {
    for (float end : {kInfinityF, -kInfinityF}) {
      float expected = std::nextafter(x, end), got = next_float_towards(x, end > 0 ? 1e-30f : -2.0f);
      wrong += std::isnan(x) ? !std::isnan(got) : std::memcmp(&got, &expected, sizeof got) != 0;
    }
  };
  constexpr float kMax = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
  for (float x : {0.0f, -0.0f, kTiny, -kTiny, kMax, -kMax, kInfinityF, -kInfinityF, 1.0f, -1.0f, NAN}) check(x);
  for (int n = 0; n < 100000; ++n) {
    std::uint32_t word = next_u32(&rng);
    float x;
    std::memcpy(&x, &word, sizeof x);
    check(x);
  }
  CHECK(wrong == 0);
}
