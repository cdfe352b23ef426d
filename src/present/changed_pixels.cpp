#include "present/changed_pixels.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "base/check.h"

namespace pocketray {

PixelBox find_changed(const std::uint8_t* before, const std::uint8_t* now, int width, int height) {
  CHECK(before != nullptr && now != nullptr);
  CHECK(width > 0 && height > 0);
  const std::size_t row_bytes = 3 * static_cast<std::size_t>(width);
  int left = width, right = 0, top = height, bottom = 0;
  for (int y = 0; y < height; ++y) {
    const std::uint8_t *a = before + static_cast<std::size_t>(y) * row_bytes, *b = now + (a - before);
    if (std::memcmp(a, b, row_bytes) == 0) continue;
    top = std::min(top, y), bottom = y + 1;
    int first = 0, last = width - 1;
    while (is_same_pixel(a + 3 * first, b + 3 * first)) ++first;
    while (is_same_pixel(a + 3 * last, b + 3 * last)) --last;
    left = std::min(left, first), right = std::max(right, last + 1);
  }
  if (bottom == 0) return {};
  CHECK(left < right && top < bottom);
  return {left, top, right - left, bottom - top};
}

}  // namespace pocketray
