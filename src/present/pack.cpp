#include "present/pack.h"

#include <cstring>

#include "base/check.h"
#include "base/float_bits.h"
#include "base/limits.h"

namespace pocketray {
namespace {

// Bayer's matrix of order 8: each of 0 … 63 once, evenly spread in every power-of-two sub-tile [Bayer 1973, fig. 4].
// Bit by bit: the lowest bits of x ^ y and y become the highest of the value.
constexpr int bayer(int x, int y) {
  int value = 0;
  for (int bit = 0; bit < 3; ++bit) value = value * 4 + (((x ^ y) >> bit) & 1) * 2 + ((y >> bit) & 1);
  return value;
}
struct BayerTable {
  std::uint16_t offset[8][8] =
      {};  // (2·value + 1) / 128 of a step, in 1/65535: thresholds at the middles of 64 intervals
};
constexpr BayerTable make_bayer_table() {
  BayerTable table;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) table.offset[y][x] = static_cast<std::uint16_t>((2 * bayer(x, y) + 1) * 65535 / 128);
  return table;
}
constexpr BayerTable kBayer = make_bayer_table();

int value_max(const PixelChannel& channel) { return (1 << channel.length) - 1; }

std::uint32_t channel_mask(const PixelChannel& channel) {
  return static_cast<std::uint32_t>(value_max(channel)) << channel.offset;
}

// Returns the channel's value nearest to an 8-bit level: round(level · max / 255).
std::uint32_t quantize_level(const PixelChannel& channel, int level) {
  return static_cast<std::uint32_t>((2 * level * value_max(channel) + 255) / 510) << channel.offset;
}

// Per-channel constants, computed once per call.
struct ChannelPacker {
  int shift;
  std::uint32_t max;
  std::uint16_t* levels;  // level → value, not yet shifted
};

struct Packer {
  std::uint16_t value_of_level[3][256];
  ChannelPacker channels[3];
  std::uint32_t ones;  // alpha
};

void make_packer(const PixelFormat& format, Packer* packer) {
  const PixelChannel* channels[3] = {&format.red, &format.green, &format.blue};
  for (int i = 0; i < 3; ++i) {
    const PixelChannel& channel = *channels[i];
    packer->channels[i] = {channel.offset, static_cast<std::uint32_t>(value_max(channel)), packer->value_of_level[i]};
    for (int level = 0; level < 256; ++level)
      packer->value_of_level[i][level] = static_cast<std::uint16_t>(quantize_level({0, channel.length}, level));
  }
  packer->ones = channel_mask(format.alpha);
}

inline std::uint32_t pack_plain(const ChannelPacker& channel, float linear, ToneCounts* counts) {
  return static_cast<std::uint32_t>(channel.levels[tone_level(linear, counts)]) << channel.shift;
}
inline std::uint32_t pack_dithered(const ChannelPacker& channel, float linear, std::uint32_t threshold,
                                   ToneCounts* counts) {
  // value · max / 65535 + threshold, rounded down. 65535 divides as (n + (n >> 16) + 1) >> 16, exact for n < 65535 ·
  // 65536.
  std::uint32_t n = tone_fine(linear, counts) * channel.max + threshold;
  return ((n + (n >> 16) + 1) >> 16) << channel.shift;
}

// The page's owner sees bytes, we see pixels. Typed for alignment: with memcpy(), ARMv5 would store byte by byte.
using Pixel16 = std::uint16_t __attribute__((may_alias));
using Pixel32 = std::uint32_t __attribute__((may_alias));

template <int kBytes>
inline void store(unsigned char* at, std::uint32_t pixel) {
  if (kBytes == 2) {
    *reinterpret_cast<Pixel16*>(at) = static_cast<Pixel16>(pixel);
  } else if (kBytes == 4) {
    *reinterpret_cast<Pixel32*>(at) = pixel;
  } else {
    at[0] = static_cast<unsigned char>(pixel);
    at[1] = static_cast<unsigned char>(pixel >> 8);
    at[2] = static_cast<unsigned char>(pixel >> 16);
  }
}

inline void store_unaligned(unsigned char* at, std::uint32_t pixel, int bytes) {
  std::uint16_t small = static_cast<std::uint16_t>(pixel);
  if (bytes == 2) std::memcpy(at, &small, sizeof small);
  if (bytes == 3) store<3>(at, pixel);
  if (bytes == 4) std::memcpy(at, &pixel, sizeof pixel);
}

// Returns whether the pixels are equal and need no counting at any exposure: neither negative nor infinite nor NaN.
inline bool looks_alike(const Vec3& a, const Vec3& b) {
  const std::uint32_t most = float_bits(kRadianceMax);
  for (int i = 0; i < 3; ++i)
    if (float_bits(a[i]) != float_bits(b[i]) || float_bits(b[i]) > most) return false;
  return true;
}

// Packs one pixel of a picture row with the row's dither thresholds.
template <bool kDither>
inline std::uint32_t packed(const Packer& packer, Vec3 c, const std::uint16_t* thresholds, int column,
                            ToneCounts* counts) {
  if (!kDither)
    return packer.ones | pack_plain(packer.channels[0], c.x, counts) | pack_plain(packer.channels[1], c.y, counts) |
           pack_plain(packer.channels[2], c.z, counts);
  std::uint32_t threshold = thresholds[column & 7];
  return packer.ones | pack_dithered(packer.channels[0], c.x, threshold, counts) |
         pack_dithered(packer.channels[1], c.y, threshold, counts) |
         pack_dithered(packer.channels[2], c.z, threshold, counts);
}

template <int kBytes, bool kDither>
ToneCounts pack_rows_of(const Vec3* radiance, int width, int height, int row_begin, int row_end, const Display& display,
                        const Packer& packer, Rotation rotation, unsigned char* pixels, int line_bytes) {
  ToneCounts counts;
  ScreenPosition right = screen_position(1, 0, width, height, rotation);
  ScreenPosition origin = screen_position(0, 0, width, height, rotation);
  int step_x = right.x - origin.x,
      step_y = right.y - origin.y;  // screen step from one picture column to the next
  std::ptrdiff_t step = static_cast<std::ptrdiff_t>(step_y) * line_bytes + step_x * kBytes;
  for (int row = row_begin; row < row_end; ++row) {
    const Vec3* in = radiance + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    ScreenPosition at = screen_position(0, row, width, height, rotation);
    unsigned char* out = pixels + static_cast<std::ptrdiff_t>(at.y) * line_bytes + at.x * kBytes;
    const std::uint16_t* thresholds = kBayer.offset[row & 7];
    std::uint32_t pixel = 0;
    for (int column = 0; column < width; ++column, out += step) {
      if (kDither || column == 0 || !looks_alike(in[column - 1], in[column]))
        pixel =
            packed<kDither>(packer, toned(in[column] * display.exposure, display.tone), thresholds, column, &counts);
      store<kBytes>(out, pixel);
    }
  }
  return counts;
}

}  // namespace

bool pixel_format_valid(const PixelFormat& format) {
  if (format.bits_per_pixel != 16 && format.bits_per_pixel != 24 && format.bits_per_pixel != 32) return false;
  std::uint64_t seen = 0;
  const PixelChannel channels[4] = {format.red, format.green, format.blue, format.alpha};
  for (const PixelChannel& channel : channels) {
    if (channel.length < 0 || channel.length > 10 || channel.offset < 0 || channel.offset > 31) return false;
    if (channel.length && channel.offset + channel.length > format.bits_per_pixel) return false;
    std::uint64_t mask = channel_mask(channel);
    if (seen & mask) return false;
    seen |= mask;
  }
  return format.red.length && format.green.length && format.blue.length;
}

bool rotation_from_degrees(int degrees, Rotation* rotation) {
  CHECK(rotation != nullptr);
  if (degrees != 0 && degrees != 90 && degrees != 180 && degrees != 270) return false;
  *rotation = static_cast<Rotation>(degrees / 90);
  return true;
}

std::uint32_t pack_levels(const PixelFormat& format, int red, int green, int blue) {
  return quantize_level(format.red, red) | quantize_level(format.green, green) | quantize_level(format.blue, blue) |
         channel_mask(format.alpha);
}

void unpack_levels(const PixelFormat& format, std::uint32_t pixel, int levels[3]) {
  const PixelChannel* channels[3] = {&format.red, &format.green, &format.blue};
  for (int i = 0; i < 3; ++i) {
    int max = value_max(*channels[i]);
    int value = static_cast<int>((pixel & channel_mask(*channels[i])) >> channels[i]->offset);
    levels[i] = (2 * value * 255 + max) / (2 * max);
  }
}

std::uint32_t read_pixel(const PixelFormat& format, const void* pixel) {
  const unsigned char* bytes = static_cast<const unsigned char*>(pixel);
  if (format.bits_per_pixel == 16) return *reinterpret_cast<const Pixel16*>(bytes);
  if (format.bits_per_pixel == 32) return *reinterpret_cast<const Pixel32*>(bytes);
  return static_cast<std::uint32_t>(bytes[0] | bytes[1] << 8 | bytes[2] << 16);
}

void write_pixel(const PixelFormat& format, void* pixel, std::uint32_t value) {
  unsigned char* bytes = static_cast<unsigned char*>(pixel);
  if (format.bits_per_pixel == 16) return store<2>(bytes, value);
  if (format.bits_per_pixel == 32) return store<4>(bytes, value);
  store<3>(bytes, value);
}

ToneCounts pack_rows(const Vec3* radiance, int width, int height, int row_begin, int row_end, const Display& display,
                     const PixelFormat& format, Rotation rotation, bool dither, void* pixels, int line_bytes) {
  CHECK(pixel_format_valid(format));
  CHECK_LE(0, row_begin);
  CHECK_LE(row_end, height);
  CHECK_LE(row_begin, row_end);
  CHECK(radiance != nullptr && pixels != nullptr);
  CHECK(rotation <= Rotation::three_quarters);
  CHECK_GE(display.exposure, 0);
  int bytes = format.bits_per_pixel / 8;
  if (bytes != 3) CHECK_EQ((reinterpret_cast<std::uintptr_t>(pixels) | static_cast<unsigned>(line_bytes)) % bytes, 0u);
  Packer packer;
  make_packer(format, &packer);
  auto rows = bytes == 2   ? (dither ? pack_rows_of<2, true> : pack_rows_of<2, false>)
              : bytes == 3 ? (dither ? pack_rows_of<3, true> : pack_rows_of<3, false>)
                           : (dither ? pack_rows_of<4, true> : pack_rows_of<4, false>);
  return rows(radiance, width, height, row_begin, row_end, display, packer, rotation,
              static_cast<unsigned char*>(pixels), line_bytes);
}

void pack_spans(const Vec3* radiance, int width, const Span* spans, std::uint32_t span_count, const Display& display,
                const PixelFormat& format, bool dither, std::uint8_t* pixels) {
  CHECK(pixel_format_valid(format));
  CHECK(span_count == 0 || (radiance != nullptr && spans != nullptr && pixels != nullptr));
  CHECK_GE(display.exposure, 0);
  Packer packer;
  make_packer(format, &packer);
  int bytes = format.bits_per_pixel / 8;
  ToneCounts counts;
  for (std::uint32_t i = 0; i < span_count; ++i) {
    const Span& span = spans[i];
    CHECK_LE(span.column_end, width);
    const Vec3* in = radiance + static_cast<std::size_t>(span.row) * static_cast<std::size_t>(width);
    const std::uint16_t* thresholds = kBayer.offset[span.row & 7];
    for (int column = span.column_begin; column < span.column_end; ++column, pixels += bytes) {
      const Vec3 c = toned(in[column] * display.exposure, display.tone);
      std::uint32_t pixel = dither ? packed<true>(packer, c, thresholds, column, &counts)
                                   : packed<false>(packer, c, thresholds, column, &counts);
      store_unaligned(pixels, pixel, bytes);
    }
  }
}

}  // namespace pocketray
