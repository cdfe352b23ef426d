// Differences between two pictures of an animation.
#pragma once
#include <cstdint>

namespace pocketray {

struct PixelBox {
  int left = 0, top = 0, width = 0, height = 0;
};

// Returns the smallest box around all pixels that differ; width 0: none differ. Rows of R, G, B without padding.
PixelBox find_changed(const std::uint8_t* before, const std::uint8_t* now, int width, int height);

inline bool is_same_pixel(const std::uint8_t* a, const std::uint8_t* b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

}  // namespace pocketray
