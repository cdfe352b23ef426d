#include "present/hud_text.h"

#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "present/hud.h"

namespace pocketray {

void add_hud_line(HudText* text, const char* format, ...) {
  CHECK(text->line_count >= 0 && text->line_count <= kHudLineMax);
  if (text->line_count == kHudLineMax) return;
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text->lines[text->line_count++], kHudColumnMax + 1, format, arguments);
  va_end(arguments);
}

void add_hud_text(HudText* text, const char* words) {
  CHECK(words != nullptr);
  constexpr std::size_t kColumns = static_cast<std::size_t>(kHudColumnMax);
  while (*words && text->line_count < kHudLineMax) {
    std::size_t length = std::strlen(words), end = length;
    if (length > kColumns) {
      for (end = kColumns; end > 0 && words[end] != ' ';) --end;
      if (end == 0) end = kColumns;  // a single long word
    }
    add_hud_line(text, "%.*s", static_cast<int>(end), words);
    words += end;
    while (*words == ' ') ++words;
  }
}

std::uint32_t hud_rows(const HudText& text) {
  return text.line_count > 0 ? static_cast<std::uint32_t>(text_box_height(text.line_count, 1)) : 0;
}

void draw_hud_text(const HudText& text, const PixelFormat& format, Rotation rotation, int width, int height,
                   void* pixels, int line_bytes) {
  if (text.line_count == 0) return;
  CHECK_LE(text.line_count, kHudLineMax);
  const char* lines[kHudLineMax];
  for (int i = 0; i < text.line_count; ++i) lines[i] = text.lines[i];
  draw_text_box({pixels, line_bytes, format, width, height, rotation}, 0, 0, 1, lines, text.line_count);
}

}  // namespace pocketray
