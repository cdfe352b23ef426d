// Strips of settings beside the reference.
#include "desktop/accuracy/strip.h"

#include <doctest/doctest.h>

#include <cstdlib>

#include "present/png_file.h"
#include "sample_sweep.h"

using namespace pocketray;

namespace {

std::array<int, 3> pixel(const Levels& picture, int column, int row) {
  std::size_t at = 3 * (static_cast<std::size_t>(row) * picture.width + static_cast<std::size_t>(column));
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

}  // namespace

// Goal: errors are shown in the colours of their scale. Method: its ends and its middle as published, rising luminance.
TEST_CASE("strip_flip_colors_run_from_black_to_light_yellow") {
  CHECK(flip_color(0) == std::array<std::uint8_t, 3>{0, 0, 4});
  CHECK(flip_color(1) == std::array<std::uint8_t, 3>{252, 253, 191});
  CHECK(flip_color(0.5f) == std::array<std::uint8_t, 3>{183, 55, 121});
  CHECK(flip_color(-1) == flip_color(0));
  CHECK(flip_color(7) == flip_color(1));
  double before = -1;
  for (int i = 0; i <= 100; ++i) {
    std::array<std::uint8_t, 3> c = flip_color(static_cast<float>(i) / 100);
    double luma = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    CHECK(luma >= before);
    before = luma;
  }
}

// Goal: each panel matches its heading in every row. Method: all pixels of a magnified and of an unmagnified picture,
// with large differences clamped.
TEST_CASE("strip_panels_hold_reference_setting_difference_and_map") {
  for (std::uint32_t width : {32u, 112u, 350u}) {
    CAPTURE(width);
    Levels reference = sample_picture(width, 24, 0);
    Strip strip = {"samples", {sample_row("samples 1", reference, 40), sample_row("samples 16", reference, 2)}};
    StripLayout at = strip_layout(reference, strip);
    Levels drawn = draw_strip(reference, strip);
    REQUIRE(drawn.width == static_cast<std::uint32_t>(at.width));
    REQUIRE(drawn.height == static_cast<std::uint32_t>(at.height));
    CHECK(at.zoom == (width == 32 ? 10 : width == 112 ? 3 : 1));
    int wrong = 0, clamped = 0;
    for (std::size_t i = 0; i < strip.rows.size(); ++i)
      for (int y = 0; y < 24; ++y)
        for (int x = 0; x < static_cast<int>(width); ++x) {
          int row = at.first_row + static_cast<int>(i) * at.row_step + y * at.zoom + at.zoom - 1;
          auto shown = [&](int panel) { return pixel(drawn, at.panel_column[panel] + x * at.zoom + at.zoom - 1, row); };
          std::array<int, 3> a = pixel(reference, x, y), b = pixel(strip.rows[i].picture, x, y), difference = {};
          for (std::size_t c = 0; c < 3; ++c) difference[c] = std::min(255, 8 * std::abs(a[c] - b[c]));
          clamped += difference[0] == 255;
          std::size_t index = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
          std::array<std::uint8_t, 3> map = flip_color(strip.rows[i].flip_map[index]);
          wrong += shown(0) != a || shown(1) != b || shown(2) != difference;
          wrong += shown(3) != std::array<int, 3>{map[0], map[1], map[2]};
        }
    CHECK(wrong == 0);
    CHECK(clamped > 0);
  }
}

// Goal: the text fits. Method: it is white, and the columns beside it and the rows between panels are not; a long label
// wraps and extends a small picture's row.
TEST_CASE("strip_text_fits_beside_its_row") {
  Levels reference = sample_picture(350, 20, 0);
  Strip strip = {"k",
                 {sample_row("a-knob-of-a-very-long-name with a value", reference, 1), sample_row("b", reference, 1)}};
  StripLayout at = strip_layout(reference, strip);
  CHECK(at.row_step > 20 + 100);
  Levels drawn = draw_strip(reference, strip);
  int inside = 0, outside = 0;
  for (int row = 0; row < at.height; ++row)
    for (int column = at.text_column; column < at.width; ++column) {
      bool ink = pixel(drawn, column, row)[0] == 255;
      bool edge = column == at.width - 1 || column == at.text_column || row == at.height - 1;
      inside += ink && !edge, outside += ink && edge;
    }
  CHECK(inside > 1000);
  CHECK(outside == 0);
}

// Goal: a strip becomes a PNG of its size. Method: the header's fields.
TEST_CASE("strip_png_has_the_size_of_the_strip") {
  Levels picture = sample_picture(300, 7, 0);
  std::string png;
  Status status = encode_png(picture, &png);
  REQUIRE_MESSAGE(status.ok, status.message);
  REQUIRE(png.size() > 24);
  CHECK(png.compare(1, 3, "PNG") == 0);
  auto byte = [&](std::size_t i) { return static_cast<unsigned char>(png[i]); };
  CHECK(byte(18) * 256 + byte(19) == 300);
  CHECK(byte(22) * 256 + byte(23) == 7);
}
