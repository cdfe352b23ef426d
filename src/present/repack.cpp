#include "present/repack.h"

#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

bool same_channel(const PixelChannel& a, const PixelChannel& b) { return a.offset == b.offset && a.length == b.length; }
bool same_format(const PixelFormat& a, const PixelFormat& b) {
  return a.bits_per_pixel == b.bits_per_pixel && same_channel(a.red, b.red) && same_channel(a.green, b.green) &&
         same_channel(a.blue, b.blue) && same_channel(a.alpha, b.alpha);
}

}  // namespace

void repack_rows(const PixelFormat& from, const void* picture, int from_line_bytes, int width, int height,
                 int row_begin, int row_end, const PixelFormat& to, Rotation rotation, void* pixels, int line_bytes) {
  CHECK(pixel_format_valid(from) && pixel_format_valid(to));
  CHECK_LE(0, row_begin);
  CHECK_LE(row_end, height);
  CHECK_LE(row_begin, row_end);
  CHECK(picture != nullptr && pixels != nullptr);
  CHECK(rotation <= Rotation::three_quarters);
  int from_bytes = from.bits_per_pixel / 8, to_bytes = to.bits_per_pixel / 8;
  CHECK_LE(width * from_bytes, from_line_bytes);
  bool as_it_lies = same_format(from, to) && rotation == Rotation::none;
  for (int row = row_begin; row < row_end; ++row) {
    const unsigned char* in =
        static_cast<const unsigned char*>(picture) + static_cast<std::ptrdiff_t>(row) * from_line_bytes;
    if (as_it_lies) {
      std::memcpy(static_cast<unsigned char*>(pixels) + static_cast<std::ptrdiff_t>(row) * line_bytes, in,
                  static_cast<std::size_t>(width) * static_cast<std::size_t>(to_bytes));
      continue;
    }
    for (int column = 0; column < width; ++column, in += from_bytes) {
      ScreenPosition at = screen_position(column, row, width, height, rotation);
      int levels[3];
      unpack_levels(from, read_pixel(from, in), levels);
      unsigned char* out =
          static_cast<unsigned char*>(pixels) + static_cast<std::ptrdiff_t>(at.y) * line_bytes + at.x * to_bytes;
      write_pixel(to, out, pack_levels(to, levels[0], levels[1], levels[2]));
    }
  }
}

}  // namespace pocketray
