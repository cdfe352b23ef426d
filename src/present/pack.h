// Radiance → screen pixels in one pass: exposure, sRGB, quantisation, dither, rotation and pixel order fused.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/span.h"
#include "base/tone.h"
#include "present/tonemap.h"

namespace pocketray {

// `length` bits, at most 10, from bit `offset` upward, of a pixel read as one integer; length 0: no such channel.
struct PixelChannel {
  int offset = 0, length = 0;
};
// 16 or 32 bits per pixel in the CPU's byte order, or 24 with the lowest byte first. Alpha is written as ones.
struct PixelFormat {
  int bits_per_pixel = 0;
  PixelChannel red, green, blue, alpha;
};
constexpr PixelFormat kRgb565 = {16, {11, 5}, {5, 6}, {0, 5}, {}};
constexpr PixelFormat kBgr565 = {16, {0, 5}, {5, 6}, {11, 5}, {}};
constexpr PixelFormat kXrgb8888 = {32, {16, 8}, {8, 8}, {0, 8}, {}};
constexpr PixelFormat kXbgr8888 = {32, {0, 8}, {8, 8}, {16, 8}, {}};
constexpr PixelFormat kRgb888 = {24, {0, 8}, {8, 8}, {16, 8}, {}};  // bytes R, G, B, as in PNG and PPM
constexpr PixelFormat kBgr888 = {24, {16, 8}, {8, 8}, {0, 8}, {}};

// Returns whether pack_rows() can write the format: 16, 24 or 32 bits, channels inside the pixel and not overlapping.
bool pixel_format_valid(const PixelFormat& format);

// Clockwise rotation of the picture on the screen. A quarter turn puts a picture of width × height on height × width
// pixels.
enum class Rotation : std::uint8_t { none, quarter, half, three_quarters };

// Converts 0, 90, 180 or 270 degrees; returns false for anything else.
bool rotation_from_degrees(int degrees, Rotation* rotation);

// Screen position of the picture's pixel (column, row), in pixels and rows.
struct ScreenPosition {
  int x, y;
};
inline ScreenPosition screen_position(int column, int row, int width, int height, Rotation rotation) {
  switch (rotation) {
    case Rotation::quarter:
      return {height - 1 - row, column};
    case Rotation::half:
      return {width - 1 - column, height - 1 - row};
    case Rotation::three_quarters:
      return {row, width - 1 - column};
    case Rotation::none:
      break;
  }
  return {column, row};
}

// Packs 8-bit levels, quantised to the format's nearest values. 565 to levels and back is the identity.
std::uint32_t pack_levels(const PixelFormat& format, int red, int green, int blue);
// Returns the 8-bit levels of a pixel, rounded to nearest.
void unpack_levels(const PixelFormat& format, std::uint32_t pixel, int levels[3]);
std::uint32_t read_pixel(const PixelFormat& format, const void* pixel);
void write_pixel(const PixelFormat& format, void* pixel, std::uint32_t value);

// Packs rows [row_begin, row_end). `radiance` is the whole picture, width × height, row 0 on top; `pixels` is the
// screen's top left, `line_bytes` (a multiple of 2 or 4 for 16 or 32 bits) the distance between screen rows. `dither`:
// ordered, 8 × 8, fixed to the picture in any rotation; its mean over a tile is within 1/64 step of the display value.
// Returns counts of values that could not be shown. Several threads may pack rows at once.
ToneCounts pack_rows(const Vec3* radiance, int width, int height, int row_begin, int row_end, const Display& display,
                     const PixelFormat& format, Rotation rotation, bool dither, void* pixels, int line_bytes);

// Packs the pixels of the spans, consecutive and unpadded, into the bytes that pack_rows() writes without rotation.
void pack_spans(const Vec3* radiance, int width, const Span* spans, std::uint32_t span_count, const Display& display,
                const PixelFormat& format, bool dither, std::uint8_t* pixels);

}  // namespace pocketray
