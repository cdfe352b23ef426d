// Pixels of the wire's formats as channels, and their spatial prediction: per channel, the median of two neighbours and
// the plane through three (LOCO-I [Weinberger, Seroussi & Sapiro 2000, sec. III-A]).
#pragma once
#include <cstdint>

namespace pocketray {

// RGB565, little-endian.
struct Pixel565 {
  static constexpr std::uint32_t kBytes = 2;
  // In coding order: green, red, blue.
  static constexpr std::uint32_t kShift[3] = {5, 11, 0}, kBits[3] = {6, 5, 5};
  static std::uint32_t load(const std::uint8_t* p) { return p[0] | std::uint32_t(p[1]) << 8; }
  static void store(std::uint8_t* p, std::uint32_t pixel) {
    p[0] = static_cast<std::uint8_t>(pixel), p[1] = static_cast<std::uint8_t>(pixel >> 8);
  }
};

// Bytes R, G, B.
struct Pixel888 {
  static constexpr std::uint32_t kBytes = 3;
  static constexpr std::uint32_t kShift[3] = {8, 0, 16}, kBits[3] = {8, 8, 8};
  static std::uint32_t load(const std::uint8_t* p) {
    return p[0] | std::uint32_t(p[1]) << 8 | std::uint32_t(p[2]) << 16;
  }
  static void store(std::uint8_t* p, std::uint32_t pixel) {
    p[0] = static_cast<std::uint8_t>(pixel), p[1] = static_cast<std::uint8_t>(pixel >> 8);
    p[2] = static_cast<std::uint8_t>(pixel >> 16);
  }
};

template <class Pixel>
std::uint32_t channel_of(std::uint32_t pixel, int channel) {
  return pixel >> Pixel::kShift[channel] & ((1u << Pixel::kBits[channel]) - 1);
}

// `corner` lies between `left` and `below`, which precede the pixel in its row and column.
template <class Pixel>
std::uint32_t predict(std::uint32_t left, std::uint32_t below, std::uint32_t corner) {
  if (left == corner) return below;
  if (below == corner) return left;
  std::uint32_t result = 0;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t mask = ((1u << Pixel::kBits[i]) - 1) << Pixel::kShift[i];
    const std::uint32_t a = left & mask, b = below & mask, c = corner & mask;
    const std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
    result |= c >= high ? low : c <= low ? high : a + b - c;
  }
  return result;
}

// Returns whether all channels agree within the tolerance.
template <class Pixel>
bool is_close(std::uint32_t a, std::uint32_t b, std::uint32_t tolerance) {
  if (a == b || tolerance == 0) return a == b;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t p = channel_of<Pixel>(a, i), q = channel_of<Pixel>(b, i);
    if ((p < q ? q - p : p - q) > tolerance) return false;
  }
  return true;
}

}  // namespace pocketray
