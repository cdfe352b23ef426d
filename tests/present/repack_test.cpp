// Pictures from elsewhere on screens of any kind.
#include "present/repack.h"

#include <doctest/doctest.h>

#include <vector>

#include "base/rng.h"

using namespace pocketray;

// Goal: a picture that went through a wire format appears as if packed directly for the screen, in every format and
// rotation. RGB888 holds all levels; RGB565, which may be dithered, goes to 565 screens. Method: random radiance, both
// ways.
TEST_CASE("repack_equals_packing_at_once") {
  constexpr int kWidth = 13, kHeight = 7;
  std::vector<Vec3> radiance(kWidth * kHeight);
  Rng rng = make_rng(7);
  for (Vec3& p : radiance) p = {next_float(&rng) * 1.2f, next_float(&rng) * 1.2f, next_float(&rng) * 1.2f};
  struct Case {
    PixelFormat wire, screen;
  } cases[] = {{kRgb888, kRgb888}, {kRgb888, kBgr888}, {kRgb888, kXrgb8888}, {kRgb888, kXbgr8888},
               {kRgb888, kRgb565}, {kRgb565, kRgb565}, {kRgb565, kBgr565}};
  for (const Case& c : cases)
    for (Rotation rotation : {Rotation::none, Rotation::quarter, Rotation::half, Rotation::three_quarters}) {
      for (bool dither : {false, true}) {
        if (dither && c.wire.bits_per_pixel != 16) continue;
        bool turned = rotation == Rotation::quarter || rotation == Rotation::three_quarters;
        int wire_line = kWidth * c.wire.bits_per_pixel / 8, bytes = c.screen.bits_per_pixel / 8;
        int line = (turned ? kHeight : kWidth) * bytes + 4 * bytes;
        std::vector<std::uint8_t> wire(static_cast<std::size_t>(wire_line) * kHeight);
        std::vector<std::uint8_t> once(static_cast<std::size_t>(line) * 16, 0xA5), twice = once;
        pack_rows(radiance.data(), kWidth, kHeight, 0, kHeight, 0.9f, c.wire, Rotation::none, dither, wire.data(),
                  wire_line);
        pack_rows(radiance.data(), kWidth, kHeight, 2, 6, 0.9f, c.screen, rotation, dither, once.data(), line);
        repack_rows(c.wire, wire.data(), wire_line, kWidth, kHeight, 2, 6, c.screen, rotation, twice.data(), line);
        CHECK(once == twice);
      }
    }
}
