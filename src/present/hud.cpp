#include "present/hud.h"

#include <cstring>

#include "base/check.h"
#include "present/font.h"

namespace pocketray {
namespace {

constexpr int kMargin = 2;  // font pixels around the text

void* pixel_at(const Canvas& canvas, int column, int row) {
  ScreenPosition at = screen_position(column, row, canvas.width, canvas.height, canvas.rotation);
  return static_cast<unsigned char*>(canvas.pixels) + static_cast<std::ptrdiff_t>(at.y) * canvas.line_bytes +
         at.x * (canvas.format.bits_per_pixel / 8);
}

struct Rectangle {
  int column_begin, column_end, row_begin, row_end;
};

Rectangle clipped(const Canvas& canvas, int column, int row, int width, int height) {
  return {column < 0 ? 0 : column, column + width > canvas.width ? canvas.width : column + width, row < 0 ? 0 : row,
          row + height > canvas.height ? canvas.height : row + height};
}

void dim(const Canvas& canvas, const Rectangle& box) {
  for (int row = box.row_begin; row < box.row_end; ++row)
    for (int column = box.column_begin; column < box.column_end; ++column) dim_pixel(canvas, column, row, 4);
}

void draw_glyph(const Canvas& canvas, int column, int row, int scale, char character, std::uint32_t ink) {
  int index = character >= ' ' && character <= '~' ? character - ' ' : '?' - ' ';
  Rectangle cell = clipped(canvas, column, row, kGlyphWidth * scale, kGlyphHeight * scale);
  for (int y = cell.row_begin; y < cell.row_end; ++y) {
    int bits = kFont[index][(y - row) / scale];
    for (int x = cell.column_begin; x < cell.column_end; ++x)
      if (bits >> (kGlyphWidth - 1 - (x - column) / scale) & 1) write_pixel(canvas.format, pixel_at(canvas, x, y), ink);
  }
}

}  // namespace

void dim_pixel(const Canvas& canvas, int column, int row, int divisor) {
  CHECK_LE(1, divisor);
  CHECK(column >= 0 && column < canvas.width && row >= 0 && row < canvas.height);
  void* pixel = pixel_at(canvas, column, row);
  int levels[3];
  unpack_levels(canvas.format, read_pixel(canvas.format, pixel), levels);
  for (int& level : levels) level /= divisor;
  write_pixel(canvas.format, pixel, pack_levels(canvas.format, levels[0], levels[1], levels[2]));
}

void set_pixel(const Canvas& canvas, int column, int row, const std::uint8_t levels[3]) {
  CHECK(column >= 0 && column < canvas.width && row >= 0 && row < canvas.height);
  write_pixel(canvas.format, pixel_at(canvas, column, row),
              pack_levels(canvas.format, levels[0], levels[1], levels[2]));
}

int text_box_width(int characters, int scale) { return (characters * kCellWidth - 1 + 2 * kMargin) * scale; }
int text_box_height(int lines, int scale) { return (lines * kCellHeight - 1 + 2 * kMargin) * scale; }

void draw_text_box(const Canvas& canvas, int column, int row, int scale, const char* const* lines, int line_count) {
  CHECK_LE(1, scale);
  CHECK(pixel_format_valid(canvas.format));
  CHECK(canvas.pixels != nullptr);
  CHECK(line_count == 0 || lines != nullptr);
  CHECK(canvas.rotation <= Rotation::three_quarters);
  int characters = 0;
  for (int i = 0; i < line_count; ++i) {
    int length = static_cast<int>(std::strlen(lines[i]));
    if (length > characters) characters = length;
  }
  if (characters == 0) return;
  dim(canvas, clipped(canvas, column, row, text_box_width(characters, scale), text_box_height(line_count, scale)));
  std::uint32_t ink = pack_levels(canvas.format, 255, 255, 255);
  for (int i = 0; i < line_count; ++i) {
    int y = row + (kMargin + i * kCellHeight) * scale;
    for (int k = 0; lines[i][k]; ++k)
      draw_glyph(canvas, column + (kMargin + k * kCellWidth) * scale, y, scale, lines[i][k], ink);
  }
}

}  // namespace pocketray
