// The text of the head-up display over a picture: lines of a fixed width.
#pragma once
#include <cstdint>

#include "present/pack.h"

namespace pocketray {

constexpr int kHudLineMax = 16, kHudColumnMax = 52;

struct HudText {
  char lines[kHudLineMax][kHudColumnMax + 1] = {};
  int line_count = 0;
};

// Adds a line, truncated to the display's width, if there is room.
void add_hud_line(HudText* text, const char* format, ...) __attribute__((format(printf, 2, 3)));

// Adds a text in as many lines as it needs, broken between words where possible.
void add_hud_text(HudText* text, const char* words);

// Number of picture rows that the display covers.
std::uint32_t hud_rows(const HudText& text);
void draw_hud_text(const HudText& text, const PixelFormat& format, Rotation rotation, int width, int height,
                   void* pixels, int line_bytes);

}  // namespace pocketray
