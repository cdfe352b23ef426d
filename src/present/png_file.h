// PNG, compressed by zlib, which takes its memory from an arena.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "present/image_file.h"

namespace pocketray {

// Arena bytes that encode_png() needs.
std::size_t encode_png_need(int width);

// Encodes width × height pixels of bytes R, G, B, row 0 on top, 8 bits per channel, marked as sRGB. Releases the arena
// to its previous mark. Fails if the arena is too small.
Status encode_png(const std::uint8_t* rgb, int width, int height, Arena* arena, const ByteSink& sink);

// Animated PNG [PNG 3rd edition, sec. 11.3.6], written frame by frame, each as the box of pixels that changed.
struct AnimatedPng {
  ByteSink sink = {};
  Arena* arena = nullptr;
  int width = 0, height = 0;
  bool has_frame = false;
  std::uint32_t sequence = 0, frames_left = 0;
  Array<std::uint8_t> last;  // R, G, B of the previous frame
};

// Arena bytes that it needs.
std::size_t animated_png_need(int width, int height);
// Begins a file of `frame_count` frames that loops forever. The arena must have animated_png_need() bytes free as long
// as the file is written.
// If there are fewer frames, write_png_frame_count() rewrites the 20 bytes at kPngFrameCountOffset.
constexpr std::uint64_t kPngFrameCountOffset = 46;
void write_png_frame_count(const ByteSink& sink, std::uint32_t frame_count);
AnimatedPng begin_animated_png(const ByteSink& sink, int width, int height, std::uint32_t frame_count, Arena* arena);
// Adds a frame shown for `delay` / `delay_unit` seconds; `rgb` as for encode_png().
Status add_png_frame(AnimatedPng* png, const std::uint8_t* rgb, std::uint16_t delay, std::uint16_t delay_unit);
void end_animated_png(AnimatedPng* png);

}  // namespace pocketray
