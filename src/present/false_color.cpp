#include "present/false_color.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "present/font.h"

namespace pocketray {
namespace {

// The map at multiples of 1/8, interpolated linearly.
constexpr std::uint8_t kViridis[9][3] = {{68, 1, 84},    {71, 45, 123}, {59, 82, 139},  {44, 114, 142}, {33, 145, 140},
                                         {40, 174, 128}, {94, 201, 98}, {173, 220, 48}, {253, 231, 37}};
constexpr int kMargin = 2;     // of a text box, in pixels
constexpr int kBarCells = 10;  // of the font

bool fits(const Legend& legend, int width) {
  return text_box_width(static_cast<int>(std::strlen(legend.text)), 1) <= width;
}

Legend scale_legend(const char* before, const char* low, const char* high, const char* after) {
  Legend legend;
  const int length =
      std::snprintf(legend.text, sizeof legend.text, "%s%s %*s %s%s", before, low, kBarCells, "", high, after);
  CHECK(length > 0 && length < static_cast<int>(sizeof legend.text));
  legend.bar_begin = static_cast<int>(std::strlen(before) + std::strlen(low)) + 1;
  legend.bar_end = legend.bar_begin + kBarCells;
  return legend;
}

}  // namespace

void viridis(float place, std::uint8_t levels[3]) {
  CHECK(levels != nullptr);
  const float at = 8 * (place > 0 ? std::min(place, 1.0f) : 0);  // NaN is 0
  const int below = std::min(static_cast<int>(at), 7);
  for (int c = 0; c < 3; ++c) {
    const float from = kViridis[below][c], to = kViridis[below + 1][c];
    levels[c] = static_cast<std::uint8_t>(from + (to - from) * (at - static_cast<float>(below)) + 0.5f);
  }
}

void color_of_number(std::uint32_t number, std::uint8_t levels[3]) {
  CHECK(levels != nullptr);
  // Finaliser of MurmurHash3 [Appleby 2011].
  std::uint32_t h = number + 0x9e3779b9u;
  h = (h ^ h >> 16) * 0x85ebca6bu;
  h = (h ^ h >> 13) * 0xc2b2ae35u;
  h ^= h >> 16;
  for (int c = 0; c < 3; ++c) levels[c] = static_cast<std::uint8_t>(64 + (h >> (8 * c) & 255) * 3 / 4);
}

Legend make_scale_legend(const char* what, const char* low, const char* high, const char* unit, int width) {
  CHECK(what != nullptr && low != nullptr && high != nullptr && unit != nullptr);
  char before[24], after[28];
  std::snprintf(before, sizeof before, "%.20s ", what);
  std::snprintf(after, sizeof after, " %.24s", unit);
  Legend legend = scale_legend(before, low, high, after);
  if (!fits(legend, width)) legend = scale_legend("", low, high, "");
  return fits(legend, width) ? legend : Legend();
}

Legend make_text_legend(const char* text, int width) {
  CHECK(text != nullptr);
  Legend legend;
  std::snprintf(legend.text, sizeof legend.text, "%s", text);
  return fits(legend, width) ? legend : Legend();
}

void draw_legend(const Canvas& canvas, int column, int row, const Legend& legend) {
  CHECK_EQ(text_box_height(1, 1), kLegendHeight);
  CHECK(column >= 0 && row >= 0 && row + kLegendHeight <= canvas.height);
  const char* const lines[] = {legend.text};
  draw_text_box(canvas, column, row, 1, lines, 1);
  const int begin = column + kMargin + legend.bar_begin * kCellWidth,
            count = (legend.bar_end - legend.bar_begin) * kCellWidth;
  for (int x = 0; x < count; ++x) {
    std::uint8_t levels[3];
    viridis(static_cast<float>(x) / static_cast<float>(count - 1), levels);
    for (int y = 0; y < kGlyphHeight; ++y) set_pixel(canvas, begin + x, row + kMargin + y, levels);
  }
}

}  // namespace pocketray
