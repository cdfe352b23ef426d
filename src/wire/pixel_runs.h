// Runs of changed pixels, as a chunk's body holds them: numbers of 7 bits a byte, low ones first, the top bit set where
// another follows. They alternate: pixels to skip, pixels that are given; skipped is what is left after the last.
#pragma once
#include <cstdint>

namespace pocketray {

// Unchanged pixels between changed ones are given, too, where they are fewer than this: a run of its own takes two
// bytes at least.
constexpr std::uint32_t kGapMin = 4;

// The most bytes that the runs of that many pixels take: two for five pixels, four beyond 127.
constexpr std::uint32_t run_bytes_max(std::uint32_t pixel_count) { return pixel_count / 2 + 16; }

constexpr std::uint32_t kNumberBytesMax = 5;

inline std::uint8_t* put_number(std::uint8_t* at, std::uint32_t value) {
  for (; value >= 128; value >>= 7) *at++ = static_cast<std::uint8_t>(value | 128);
  *at++ = static_cast<std::uint8_t>(value);
  return at;
}

// Null where the bytes end within the number or it has more than 32 bits.
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
