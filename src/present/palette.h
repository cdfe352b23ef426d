// Palettes: the colours that stand for a picture's pixels in formats with few colours.
#pragma once
#include <cstdint>

#include "base/array.h"

namespace pocketray {

struct Rgb {
  std::uint8_t channel[3];  // red, green, blue; levels as displayed
};
inline bool operator==(const Rgb& a, const Rgb& b) {
  return a.channel[0] == b.channel[0] && a.channel[1] == b.channel[1] && a.channel[2] == b.channel[2];
}

constexpr std::uint32_t kPaletteMax = 256;
struct Palette {
  std::uint32_t count = 0;
  Rgb colors[kPaletteMax];
};

// The colours of the samples themselves if at most `count_max` differ, otherwise as many that stand for all. Changes
// the order of the samples, of which there are 1 to 65,536; the palette depends on their colours alone.
constexpr std::uint32_t kPaletteSampleMax = 1u << 16;
void make_palette(Array<Rgb> samples, std::uint32_t count_max, Palette* palette);

// Index of the nearest colour, the first of several.
std::uint32_t nearest_color(const Palette& palette, const Rgb& color);

}  // namespace pocketray
