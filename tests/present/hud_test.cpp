#include "present/hud.h"

#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "present/font.h"
#include "present/png_file.h"

using namespace pocketray;

namespace {

constexpr int kWidth = 320, kHeight = 240;

std::vector<Vec3> scene() {
  std::vector<Vec3> radiance(kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      radiance[static_cast<std::size_t>(y * kWidth + x)] = {
          static_cast<float>(x) / kWidth, static_cast<float>(y) / kHeight, 1 - static_cast<float>(x) / kWidth};
  return radiance;
}

struct Page {
  std::vector<std::uint32_t> memory;
  Canvas canvas;
  Page(const PixelFormat& format, Rotation rotation, bool dither) {
    bool turned = rotation == Rotation::quarter || rotation == Rotation::three_quarters;
    int bytes = format.bits_per_pixel / 8;
    canvas = {nullptr, (turned ? kHeight : kWidth) * bytes, format, kWidth, kHeight, rotation};
    memory.assign(kWidth * kHeight, 0);
    canvas.pixels = memory.data();
    pack_rows(scene().data(), kWidth, kHeight, 0, kHeight, 1, format, rotation, dither, canvas.pixels,
              canvas.line_bytes);
  }
  std::uint32_t pixel(int column, int row) const {
    ScreenPosition at = screen_position(column, row, kWidth, kHeight, canvas.rotation);
    const char* base = static_cast<const char*>(canvas.pixels);
    return read_pixel(canvas.format, base + at.y * canvas.line_bytes + at.x * (canvas.format.bits_per_pixel / 8));
  }
};

}  // namespace

// Goal: a legible font: every printable character has a distinct glyph and stays in its cell. Method: the table.
TEST_CASE("hud_font_has_a_glyph_of_its_own_for_every_printable_character") {
  std::set<std::string> glyphs;
  for (const auto& glyph : kFont) {
    glyphs.insert(std::string(reinterpret_cast<const char*>(glyph), kGlyphHeight));
    for (std::uint8_t row : glyph) CHECK(row < 1 << kGlyphWidth);
  }
  CHECK(glyphs.size() == 95);
}

// Goal: the box covers the documented area, dims it to a quarter and changes nothing else; the text is in place,
// however the picture is rotated. Method: every pixel against the plain picture, by the font's own bits.
TEST_CASE("hud_box_dims_its_pixels_and_touches_no_others") {
  const char* const lines[] = {"H", "|?"};
  for (const PixelFormat& format : {kRgb565, kXrgb8888, kRgb888}) {
    for (Rotation rotation : {Rotation::none, Rotation::quarter, Rotation::half, Rotation::three_quarters}) {
      for (int scale : {1, 2}) {
        Page before(format, rotation, false), after(format, rotation, false);
        draw_text_box(after.canvas, 10, 20, scale, lines, 2);
        int right = 10 + text_box_width(2, scale), bottom = 20 + text_box_height(2, scale), wrong = 0, inked = 0;
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            std::uint32_t expected = before.pixel(x, y);
            if (x >= 10 && x < right && y >= 20 && y < bottom) {
              int levels[3];
              unpack_levels(format, expected, levels);
              expected = pack_levels(format, levels[0] / 4, levels[1] / 4, levels[2] / 4);
              int cell_x = (x - 10) / scale - 2, cell_y = (y - 20) / scale - 2;
              bool ink = false;
              if (cell_x >= 0 && cell_y >= 0 && cell_x % kCellWidth < kGlyphWidth &&
                  cell_y % kCellHeight < kGlyphHeight) {
                const char* line = cell_y / kCellHeight < 2 ? lines[cell_y / kCellHeight] : "";
                std::size_t index = static_cast<std::size_t>(cell_x / kCellWidth);
                if (index < std::strlen(line))
                  ink = kFont[line[index] - ' '][cell_y % kCellHeight] >> (4 - cell_x % kCellWidth) & 1;
              }
              if (ink) expected = pack_levels(format, 255, 255, 255);
              inked += ink;
            }
            wrong += after.pixel(x, y) != expected;
          }
        }
        CHECK(wrong == 0);
        CHECK(inked == (17 + 7 + 9) * scale * scale);  // pixels of H, | and ?
      }
    }
  }
}

// Goal: text never leaves the picture. Method: boxes over each edge, far outside, and characters beyond ASCII; guard
// bytes after the picture stay intact.
TEST_CASE("hud_cuts_what_lies_outside_of_the_picture") {
  const char* const lines[] = {"outside", "\xc3\xa4\x01"};
  Page page(kRgb888, Rotation::none, false);
  constexpr std::size_t kGuard = 2 * 3 * kWidth;  // two rows on either side
  std::vector<std::uint8_t> memory(3 * kWidth * kHeight + 2 * kGuard, 0xa5);
  page.canvas.pixels = memory.data() + kGuard;
  const int places[][2] = {{-20, -5},
                           {300, 230},
                           {-1000, 50},
                           {1000, 1000},
                           {-20, 235},
                           {300, -5},
                           {9, kHeight + 1 - text_box_height(2, 2)},
                           {kWidth + 1 - text_box_width(7, 2), 9}};
  for (const auto& place : places) draw_text_box(page.canvas, place[0], place[1], 2, lines, 2);
  int touched = 0;
  for (std::size_t i = 0; i < kGuard; ++i) touched += (memory[i] != 0xa5) + (memory[memory.size() - 1 - i] != 0xa5);
  CHECK(touched == 0);
  Page unknown(kRgb888, Rotation::none, false), question(kRgb888, Rotation::none, false);
  const char *umlaut = "\xfc", *mark = "?";
  draw_text_box(unknown.canvas, 0, 0, 1, &umlaut, 1);
  draw_text_box(question.canvas, 0, 0, 1, &mark, 1);
  CHECK(unknown.memory == question.memory);
}

// Goal: pictures for inspection. Method: with POCKETRAY_PICTURES=FOLDER set, the HUD on RGB8, and a screen for a panel
// rotated by 90 degrees, RGB565 dithered; both must at least be written.
TEST_CASE("hud_pictures_can_be_written_to_look_at") {
  const char* const lines[] = {"33.4 ms/frame   435 ns/pixel",
                               "rays 152,340: camera 76,800 shadow 61,440",
                               "memory 4.1 of 16.0 MiB",
                               "effects: shadow mirror specular",
                               " !\"#$%&'()*+,-./0123456789:;<=>?@",
                               "ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_`",
                               "abcdefghijklmnopqrstuvwxyz{|}~"};
  const char* folder = std::getenv("POCKETRAY_PICTURES");
  std::vector<std::uint8_t> block(encode_png_need(kWidth) + kArenaAlignment);
  Arena arena = make_arena("frame", block.data(), block.size());
  for (bool turned : {false, true}) {
    Page page(turned ? kRgb565 : kRgb888, turned ? Rotation::quarter : Rotation::none, turned);
    draw_text_box(page.canvas, 4, 4, 1, lines, 7);
    int width = turned ? kHeight : kWidth, height = turned ? kWidth : kHeight;
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < width * height; ++i) {
      int levels[3];
      const char* base = static_cast<const char*>(page.canvas.pixels);
      unpack_levels(page.canvas.format, read_pixel(page.canvas.format, base + i * (turned ? 2 : 3)), levels);
      for (int level : levels) rgb.push_back(static_cast<std::uint8_t>(level));
    }
    std::string png;
    ByteSink sink = {[](void* user, const void* bytes, std::size_t count) {
                       static_cast<std::string*>(user)->append(static_cast<const char*>(bytes), count);
                     },
                     &png};
    CHECK(encode_png(rgb.data(), width, height, &arena, sink).ok);
    if (!folder) continue;
    std::FILE* file = std::fopen((std::string(folder) + (turned ? "/turned.png" : "/hud.png")).c_str(), "wb");
    REQUIRE(file != nullptr);
    CHECK(std::fwrite(png.data(), 1, png.size(), file) == png.size());
    std::fclose(file);
  }
}
