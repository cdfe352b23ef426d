// False colours for numbers, as levels R, G and B, and legends for them.
#pragma once
#include <cstdint>

#include "present/hud.h"

namespace pocketray {

// The map "viridis", from dark violet (0) over blue and green to yellow (1): equal steps look equal, also in grey and
// to the colour-blind [Smith and van der Walt 2015]. Places outside are moved to the nearer end.
void viridis(float place, std::uint8_t levels[3]);

// A colour that neighbouring numbers do not share, never dark.
void color_of_number(std::uint32_t number, std::uint8_t levels[3]);

// A line of text with a gap that shows viridis.
struct Legend {
  char text[80] = {0};
  int bar_begin = 0, bar_end = 0;  // characters of the gap; equal: none
};
// "cost 0 ▇▇▇▇ 412 boxes and triangles", or as much of it as fits into `width` pixels; empty if that is not even the
// numbers.
Legend make_scale_legend(const char* what, const char* low, const char* high, const char* unit, int width);
// Plain text, empty if it does not fit.
Legend make_text_legend(const char* text, int width);
constexpr int kLegendHeight = 11;  // pixels
// Draws it with its top left corner at (column, row).
void draw_legend(const Canvas& canvas, int column, int row, const Legend& legend);

}  // namespace pocketray
