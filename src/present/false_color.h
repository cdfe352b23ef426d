// False colours for numbers, as levels R, G and B, and their legends.
#pragma once
#include <cstdint>

#include "present/hud.h"

namespace pocketray {

// The map "viridis", from dark violet (0) through blue and green to yellow (1): perceptually uniform, also in grey and
// for colour-blind viewers [Smith and van der Walt 2015]. Places outside are clamped.
void viridis(float place, std::uint8_t levels[3]);

// A colour that differs between neighbouring numbers and is never dark.
void color_of_number(std::uint32_t number, std::uint8_t levels[3]);

// A line of text with a gap for a bar in viridis.
struct Legend {
  char text[80] = {0};
  int bar_begin = 0, bar_end = 0;  // first and end character of the gap; equal: none
};
// "cost 0 ▇▇▇▇ 412 boxes and triangles", shortened to fit `width` pixels;
// empty if not even the numbers fit.
Legend make_scale_legend(const char* what, const char* low, const char* high, const char* unit, int width);
// Plain text; empty if it does not fit.
Legend make_text_legend(const char* text, int width);
constexpr int kLegendHeight = 11;  // pixels
// Draws the legend with its top left corner at (column, row).
void draw_legend(const Canvas& canvas, int column, int row, const Legend& legend);

}  // namespace pocketray
