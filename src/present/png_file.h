// PNG, compressed by zlib, which takes its memory from an arena.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "present/image_file.h"

namespace pocketray {

// Bytes of arena that encode_png() takes.
std::size_t encode_png_need(int width);

// width × height pixels of bytes R, G, B, row 0 on top, 8 bits per channel, marked as sRGB. Releases the arena to its
// previous mark. Fails if the arena is too small.
Status encode_png(const std::uint8_t* rgb, int width, int height, Arena* arena, const ByteSink& sink);

}  // namespace pocketray
