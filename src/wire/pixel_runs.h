// Runs of changed pixels in the body of a chunk: numbers of 7 bits per byte, low bits first, the top bit set if another
// byte follows. They alternate between pixels to skip and pixels given; all pixels after the last are skipped.
#pragma once
#include <cstdint>

namespace pocketray {

// Fewer unchanged pixels than this between changed ones are given, too: a separate run takes at least two bytes.
constexpr std::uint32_t kGapMin = 4;

// Upper bound of the bytes of the runs of that many pixels: two for five pixels, four beyond 127.
constexpr std::uint32_t run_bytes_max(std::uint32_t pixel_count) { return pixel_count / 2 + 16; }

constexpr std::uint32_t kNumberBytesMax = 5;

inline std::uint8_t* put_number(std::uint8_t* at, std::uint32_t value) {
  for (; value >= 128; value >>= 7) *at++ = static_cast<std::uint8_t>(value | 128);
  *at++ = static_cast<std::uint8_t>(value);
  return at;
}

// Null if the bytes end within the number or it has more than 32 bits.
inline const std::uint8_t* get_number(const std::uint8_t* at, const std::uint8_t* end, std::uint32_t* value) {
  *value = 0;
  for (std::uint32_t shift = 0; at < end && shift < 35; shift += 7) {
    std::uint32_t bits = *at & 127u;
    if (shift == 28 && bits > 15) return nullptr;
    *value |= bits << shift;
    if (!(*at++ & 128)) return at;
  }
  return nullptr;
}

}  // namespace pocketray
