// Animated GIF, written frame by frame.
#pragma once
#include "base/arena.h"
#include "present/changed_pixels.h"
#include "present/image_file.h"
#include "present/palette.h"

namespace pocketray {

struct LzwTable;

struct GifWriter {
  ByteSink sink = {};
  int width = 0, height = 0;
  bool has_frame = false;
  Array<std::uint8_t> last;           // R, G, B of the previous frame
  Array<Rgb> samples;                 // for the frame's palette
  Array<std::uint32_t> known_colors;  // a cache of nearest_color()
  LzwTable* table = nullptr;
};

// Arena bytes that a writer needs.
std::size_t gif_need(int width, int height);
// Begins a file that loops forever. The arena must have gif_need() bytes free as long as the writer is used.
GifWriter begin_gif(const ByteSink& sink, int width, int height, Arena* arena);
// Adds a frame shown for `centiseconds`, with its own palette and only the changed pixels. `rgb`: width × height pixels
// of bytes R, G, B, row 0 on top.
void add_gif_frame(GifWriter* gif, const std::uint8_t* rgb, std::uint32_t centiseconds);
void end_gif(GifWriter* gif);

}  // namespace pocketray
