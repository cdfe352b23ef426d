// Text over a picture: a translucent dark box with lines in a small font, drawn into packed pixels, rotated like the
// picture.
#pragma once
#include "present/pack.h"

namespace pocketray {

// Packed pixels of a picture, as written by pack_rows(): a screen's page, or a picture of bytes R, G, B (kRgb888).
struct Canvas {
  void* pixels = nullptr;
  int line_bytes = 0;
  PixelFormat format;
  int width = 0, height = 0;  // of the picture, before rotation
  Rotation rotation = Rotation::none;
};

// Divides the levels of a picture's pixel.
void dim_pixel(const Canvas& canvas, int column, int row, int divisor);

void set_pixel(const Canvas& canvas, int column, int row, const std::uint8_t levels[3]);

// Size in pixels of a box with that much text, including its margin. `scale`: pixels per font pixel, at least 1.
int text_box_width(int characters, int scale);
int text_box_height(int lines, int scale);

// Draws the box with its top left corner at (column, row) of the picture, as wide as its longest line, clipped to the
// picture. Characters other than printable ASCII appear as '?'. Dims the picture below to a quarter, so first repack
// the covered rows: from row to row + text_box_height().
void draw_text_box(const Canvas& canvas, int column, int row, int scale, const char* const* lines, int line_count);

}  // namespace pocketray
