// False colours and their legends.
#include "present/false_color.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "base/color.h"

using namespace pocketray;

namespace {

// CIELAB lightness, 0 to 100.
double lightness(const std::uint8_t levels[3]) {
  const double y =
      static_cast<double>(luminance({srgb_to_linear(levels[0]), srgb_to_linear(levels[1]), srgb_to_linear(levels[2])}));
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

}  // namespace

// Goal: the map is even to the eye: equal steps are equally much lighter. Method: lightness at 101 places against a
// straight line; both ends; places outside and NaN.
TEST_CASE("viridis_is_even") {
  std::uint8_t first[3], last[3], levels[3];
  viridis(0, first), viridis(1, last);
  CHECK((first[0] == 68 && first[1] == 1 && first[2] == 84));
  CHECK((last[0] == 253 && last[1] == 231 && last[2] == 37));
  const double low = lightness(first), high = lightness(last);
  CHECK(high - low > 70);
  double before = low;
  for (int i = 1; i <= 100; ++i) {
    viridis(static_cast<float>(i) / 100, levels);
    CAPTURE(i);
    CHECK(lightness(levels) > before - 0.01);
    CHECK(std::fabs(lightness(levels) - (low + (high - low) * i / 100)) < 3);
    before = lightness(levels);
  }
  for (float place : {-1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    viridis(place, levels);
    CHECK(std::memcmp(levels, first, 3) == 0);
  }
  viridis(2, levels);
  CHECK(std::memcmp(levels, last, 3) == 0);
}

// Goal: numbers have colours of their own that are seen on black. Method: the first 10,000: few collide, all are bright
// enough, neighbours differ.
TEST_CASE("numbers_have_colors_of_their_own") {
  std::set<std::uint32_t> seen;
  std::uint32_t before = 0;
  for (std::uint32_t i = 0; i < 10'000; ++i) {
    std::uint8_t c[3];
    color_of_number(i, c);
    CHECK(std::min({c[0], c[1], c[2]}) >= 64);
    const std::uint32_t color = std::uint32_t(c[0]) << 16 | std::uint32_t(c[1]) << 8 | c[2];
    CHECK(color != before);
    before = color;
    seen.insert(color);
  }
  CHECK(seen.size() > 9'900);
}

// Goal: a legend has the numbers and the map between them, as much as fits. Method: text at several widths; the pixels
// of the bar, and that none outside the box changes.
TEST_CASE("legend_shows_the_scale") {
  CHECK(std::string(make_scale_legend("cost", "0", "412", "boxes", 320).text) == "cost 0            412 boxes");
  CHECK(std::string(make_scale_legend("cost", "0", "412", "boxes", 120).text) == "0            412");
  CHECK(make_scale_legend("cost", "0", "412", "boxes", 60).text[0] == 0);
  CHECK(make_text_legend("abc", 10).text[0] == 0);
  const Legend legend = make_scale_legend("cost", "0", "412", "boxes", 320);
  constexpr int kWidth = 320, kHeight = 40;
  std::vector<std::uint8_t> rgb(3 * kWidth * kHeight, 200);
  draw_legend({rgb.data(), 3 * kWidth, kRgb888, kWidth, kHeight, Rotation::none}, 0, kHeight - kLegendHeight, legend);
  auto pixel = [&](int x, int y) { return &rgb[static_cast<std::size_t>(3 * (y * kWidth + x))]; };
  const int begin = 2 + 6 * legend.bar_begin, end = 2 + 6 * legend.bar_end, row = kHeight - kLegendHeight / 2;
  std::uint8_t levels[3];
  viridis(0, levels);
  CHECK(std::memcmp(pixel(begin, row), levels, 3) == 0);
  viridis(1, levels);
  CHECK(std::memcmp(pixel(end - 1, row), levels, 3) == 0);
  CHECK(*pixel(begin - 1, row) == 50);  // a quarter
  for (int x = 0; x < kWidth; ++x)
    for (int y = 0; y < kHeight - kLegendHeight; ++y) CHECK(*pixel(x, y) == 200);
}
