#include "base/color.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "support/hard_case.h"

using namespace pocketray;

// Goal: display levels are the standard's. Method: HARDCASES row 64, and every level's round trip.
TEST_CASE("hard_64_srgb_levels_round_trip_and_are_defined_for_every_float") {
  count_assertions("256 round trips, .5 is 188, .18 is 118");
  CHECK(srgb_level(0.5f) == 188);
  CHECK(srgb_level(0.18f) == 118);
  for (int level = 0; level < 256; ++level)
    CHECK(srgb_level(srgb_to_linear(static_cast<std::uint8_t>(level))) == level);
  CHECK(srgb_level(-1) == 0);
  CHECK(srgb_level(std::numeric_limits<float>::quiet_NaN()) == 0);
  CHECK(srgb_level(std::numeric_limits<float>::infinity()) == 255);
}

// Goal: the tables are the standard's curve. Method: IEC 61966-2-1 in double by the C library, every level and every
// threshold between levels; the neighbouring float below a threshold shows the level below.
TEST_CASE("srgb_tables_follow_the_standard") {
  auto decode = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  for (int level = 0; level < 256; ++level) {
    CAPTURE(level);
    CHECK(kSrgb.linear[level] == doctest::Approx(decode(level / 255.0)).epsilon(1e-7));
    if (level == 0) continue;
    float threshold = kSrgb.threshold[level];
    CHECK(threshold == doctest::Approx(decode((level - 0.5) / 255.0)).epsilon(1e-7));
    CHECK(srgb_level(threshold) == level);
    CHECK(srgb_level(std::nextafter(threshold, 0.0f)) == level - 1);
    CHECK(threshold - kSrgb.threshold[level - 1] >= kHalfLevel * 0.999999f);  // no level is narrower
  }
  CHECK(luminance({1, 1, 1}) == doctest::Approx(1));
  CHECK(luminance({0, 1, 0}) > luminance({1, 0, 1}));
}
