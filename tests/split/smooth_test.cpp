// Smoothing of measurements.
#include "split/smooth.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "base/rng.h"

using namespace pocketray;

TEST_CASE("smooth_takes_the_first_sample_as_it_is") {
  Smoothed s;
  CHECK(!is_known(s));
  smooth(&s, 42);
  CHECK(s.value == 42.0f);
}

// Goal: noise around a value leaves the estimate near it. Method: ±30 % uniform noise, 300 samples.
TEST_CASE("smooth_stays_near_a_noisy_value") {
  Rng rng = make_rng(1);
  Smoothed s;
  double worst = 0;
  for (int i = 0; i < 300; ++i) {
    smooth(&s, 100 * (0.7 + 0.6 * next_double(&rng)));
    if (i >= 20) worst = std::fmax(worst, std::fabs(static_cast<double>(s.value) - 100));
  }
  CHECK(worst < 28);
}

// Goal: a single outlier in either direction changes nothing.
TEST_CASE("smooth_ignores_a_lone_outlier") {
  for (double outlier : {5000.0, 2.0}) {
    Smoothed s;
    for (int i = 0; i < 8; ++i) smooth(&s, 100);
    smooth(&s, outlier);
    CHECK(s.value == 100.0f);
    smooth(&s, 100);
    smooth(&s, outlier);
    smooth(&s, 100);
    CHECK(s.value == 100.0f);
  }
}

// Goal: a lasting change is adopted with the third sample, up or down.
TEST_CASE("smooth_follows_a_lasting_change_within_three_samples") {
  for (double factor : {5.0, 0.2, 1.5, 0.7}) {
    Smoothed s;
    for (int i = 0; i < 8; ++i) smooth(&s, 100);
    for (int i = 0; i < 3; ++i) smooth(&s, 100 * factor);
    CHECK(s.value == doctest::Approx(100 * factor));
  }
}

// Goal: samples that alternate between two values leave an estimate between them that hardly moves.
TEST_CASE("smooth_settles_between_alternating_values") {
  for (double high : {130.0, 190.0, 800.0}) {
    Smoothed s;
    double least = 1e30, most = 0;
    for (int i = 0; i < 100; ++i) {
      smooth(&s, i % 2 ? high : 100);
      if (i < 50) continue;
      least = std::fmin(least, static_cast<double>(s.value)), most = std::fmax(most, static_cast<double>(s.value));
    }
    CHECK(least >= 100);
    CHECK(most <= high);
    CHECK(most / least < 1.2);
  }
}

// Goal: invalid samples change nothing, whether or not a value is known; extreme ones leave it finite and positive.
TEST_CASE("smooth_ignores_what_is_no_measurement") {
  const double inf = std::numeric_limits<double>::infinity();
  for (double bad : {0.0, -0.0, -1.0, inf, -inf, std::nan(""), 5e-324, 1e300}) {
    Smoothed s;
    smooth(&s, bad);
    CHECK(!is_known(s));
    smooth(&s, 7);
    for (int i = 0; i < 5; ++i) smooth(&s, bad);
    CHECK(s.value == 7.0f);
    scale(&s, bad);
    CHECK(s.value == 7.0f);
  }
  for (double extreme : {1e-30, 1e30})
    for (double other : {1e-30, 1.0, 1e30}) {
      Smoothed s;
      smooth(&s, extreme);
      for (int i = 0; i < 9; ++i) smooth(&s, other), scale(&s, extreme);
      CHECK(std::isfinite(s.value));
      CHECK(s.value > 0);
    }
}

TEST_CASE("scale_multiplies_the_value_and_the_run") {
  Smoothed s;
  smooth(&s, 10);
  smooth(&s, 15);
  smooth(&s, 15);
  scale(&s, 4);
  smooth(&s, 60);
  CHECK(s.value == doctest::Approx(60));
}
