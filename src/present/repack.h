// Packed pixels → screen pixels: converts and rotates a picture received in another format.
#pragma once
#include "present/pack.h"

namespace pocketray {

// Converts rows [row_begin, row_end) of a picture of width × height pixels in `from`, with rows of `from_line_bytes`.
// Writes what pack_rows() would for the same levels without dither: each channel becomes the nearest value of `to`.
void repack_rows(const PixelFormat& from, const void* picture, int from_line_bytes, int width, int height,
                 int row_begin, int row_end, const PixelFormat& to, Rotation rotation, void* pixels, int line_bytes);

}  // namespace pocketray
