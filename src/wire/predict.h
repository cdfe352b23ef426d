// Prediction: a pixel as its difference, per channel and modulo the channel's levels, from the median of its left and
// upper neighbours and the plane through them (LOCO-I [Weinberger, Seroussi & Sapiro 2000, sec. III-A]); the difference
// of green is then subtracted from those of red and blue. Only neighbours within the chunk count.
#pragma once
#include <cstdint>

namespace pocketray {

// RGB565, little-endian.
struct Pixel565 {
  static constexpr std::uint32_t kBytes = 2;
  static constexpr std::uint32_t kChannels[3] = {0x001F, 0x07E0, 0xF800};
  static std::uint32_t load(const std::uint8_t* p) { return p[0] | std::uint32_t(p[1]) << 8; }
  static void store(std::uint8_t* p, std::uint32_t pixel) {
    p[0] = static_cast<std::uint8_t>(pixel), p[1] = static_cast<std::uint8_t>(pixel >> 8);
  }
  // The difference of green for red and blue, which have half its levels: modulo those, halving needs no sign.
  static std::uint32_t green_share(std::uint32_t difference) {
    std::uint32_t half = (difference >> 5 & 63) >> 1;
    return half | half << 11;
  }
};

// Bytes R, G, B.
struct Pixel888 {
  static constexpr std::uint32_t kBytes = 3;
  static constexpr std::uint32_t kChannels[3] = {0x0000FF, 0x00FF00, 0xFF0000};
  static std::uint32_t load(const std::uint8_t* p) {
    return p[0] | std::uint32_t(p[1]) << 8 | std::uint32_t(p[2]) << 16;
  }
  static void store(std::uint8_t* p, std::uint32_t pixel) {
    p[0] = static_cast<std::uint8_t>(pixel), p[1] = static_cast<std::uint8_t>(pixel >> 8);
    p[2] = static_cast<std::uint8_t>(pixel >> 16);
  }
  static std::uint32_t green_share(std::uint32_t difference) {
    std::uint32_t green = difference >> 8 & 255;
    return green | green << 16;
  }
};

template <class Pixel>
std::uint32_t add_channels(std::uint32_t a, std::uint32_t b) {
  std::uint32_t sum = 0;
  for (std::uint32_t channel : Pixel::kChannels) sum |= ((a & channel) + (b & channel)) & channel;
  return sum;
}
template <class Pixel>
std::uint32_t subtract_channels(std::uint32_t a, std::uint32_t b) {
  std::uint32_t difference = 0;
  for (std::uint32_t channel : Pixel::kChannels) difference |= ((a & channel) - (b & channel)) & channel;
  return difference;
}

// The prediction of the pixel at `index` in a chunk; `column` is its place in its row.
template <class Pixel>
std::uint32_t predict(const std::uint8_t* pixels, std::uint32_t at, std::uint32_t column, std::uint32_t width) {
  const std::uint8_t* here = pixels + at * Pixel::kBytes;
  if (at < width) return column > 0 ? Pixel::load(here - Pixel::kBytes) : 0;
  const std::uint8_t* above = here - width * Pixel::kBytes;
  if (column == 0) return Pixel::load(above);
  std::uint32_t left = Pixel::load(here - Pixel::kBytes), up = Pixel::load(above);
  std::uint32_t corner = Pixel::load(above - Pixel::kBytes);
  if (left == corner) return up;
  if (up == corner) return left;
  std::uint32_t result = 0;
  for (std::uint32_t channel : Pixel::kChannels) {
    std::uint32_t a = left & channel, b = up & channel, c = corner & channel;
    std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
    result |= c >= high ? low : c <= low ? high : a + b - c;
  }
  return result;
}

template <class Pixel>
std::uint32_t difference_of(std::uint32_t pixel, std::uint32_t predicted) {
  std::uint32_t difference = subtract_channels<Pixel>(pixel, predicted);
  return subtract_channels<Pixel>(difference, Pixel::green_share(difference));
}
template <class Pixel>
std::uint32_t pixel_of(std::uint32_t difference, std::uint32_t predicted) {
  return add_channels<Pixel>(add_channels<Pixel>(difference, Pixel::green_share(difference)), predicted);
}

}  // namespace pocketray
