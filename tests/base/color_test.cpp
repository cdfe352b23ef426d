#include "base/color.h"

#include <doctest/doctest.h>

#include <limits>

using namespace pocketray;

// Goal: display levels are the standard's. Method: HARDCASES row 64, and every level's round trip.
TEST_CASE("hard_64_srgb_levels_round_trip_and_are_defined_for_every_float") {
  CHECK(srgb_level(0.5f) == 188);
  CHECK(srgb_level(0.18f) == 118);
  for (int level = 0; level < 256; ++level) CHECK(srgb_level(srgb_to_linear(static_cast<std::uint8_t>(level))) == level);
  CHECK(srgb_level(-1) == 0);
  CHECK(srgb_level(std::numeric_limits<float>::quiet_NaN()) == 0);
  CHECK(srgb_level(std::numeric_limits<float>::infinity()) == 255);
}
