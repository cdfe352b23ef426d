// What the display over the picture says, and its drawing.
#pragma once
#include "app/camera_control.h"
#include "app/progressive.h"
#include "present/pack.h"

namespace pocketray {

constexpr int kHudLineMax = 16, kHudColumnMax = 52;

struct HudText {
  char lines[kHudLineMax][kHudColumnMax + 1] = {};
  int line_count = 0;
};

// Something to be told over the picture for some seconds, or until there is something else.
struct HudNote {
  char text[600] = {0};
  std::uint64_t until_ns = 0;  // by the screen's clock
  std::uint32_t number = 0;    // how many there have been
};

// Adds a line, cut to the display's width, where there is room for one.
void add_hud_line(HudText* text, const char* format, ...) __attribute__((format(printf, 2, 3)));

// Milliseconds per frame, nanoseconds per pixel, rays, memory, effects on.
void write_hud(const Renderer& renderer, const Progressive& progressive, CameraMode mode, HudText* text);
void write_waiting(const char* what, double seconds, HudText* text);
// Adds a text in as many lines as it takes, broken between words where it has some.
void add_hud_text(HudText* text, const char* words);

// Rows of the picture the display covers.
std::uint32_t hud_rows(const HudText& text);
void draw_hud_text(const HudText& text, const PixelFormat& format, Rotation rotation, int width, int height,
                   void* pixels, int line_bytes);

}  // namespace pocketray
