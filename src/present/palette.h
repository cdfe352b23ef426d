// Palettes: the colours that represent a picture's pixels in formats with few colours.
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

// Returns the samples' own colours if at most `count_max` differ, otherwise as many representatives. Reorders the
// samples, of which there are 1 to 65,536; the palette depends only on their colours.
constexpr std::uint32_t kPaletteSampleMax = 1u << 16;
void make_palette(Array<Rgb> samples, std::uint32_t count_max, Palette* palette);

// Returns the index of the nearest colour, on ties the first.
std::uint32_t nearest_color(const Palette& palette, const Rgb& color);

}  // namespace pocketray
