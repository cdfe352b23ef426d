// PNG by libpng, which gets all its memory, zlib's included, from an arena.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "present/image_file.h"

namespace pocketray {

// Bytes of arena that encode_png() takes; 0 in a build without libpng.
std::size_t encode_png_need(int width);

// width × height pixels of bytes R, G, B, row 0 on top, 8 bits per channel, marked as sRGB. The arena is released to
// where it was. Fails in a build without libpng, and when the arena is too small.
Status encode_png(const std::uint8_t* rgb, int width, int height, Arena* arena, const ByteSink& sink);

}  // namespace pocketray
