// Packed pixels → screen pixels: a picture that came from elsewhere, in another format, turned.
#pragma once
#include "present/pack.h"

namespace pocketray {

// Rows [row_begin, row_end) of a picture of width × height pixels in `from`, rows of `from_line_bytes`, as pack_rows()
// would have put them on the screen without dither had they the same levels: each channel to the nearest value `to`
// has.
void repack_rows(const PixelFormat& from, const void* picture, int from_line_bytes, int width, int height,
                 int row_begin, int row_end, const PixelFormat& to, Rotation rotation, void* pixels, int line_bytes);

}  // namespace pocketray
