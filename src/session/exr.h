// OpenEXR, in builds with its library.
#pragma once
#include "base/status.h"
#include "present/image_file.h"

namespace pocketray {

bool has_exr();
// Writes linear values as 32-bit floats in channels R, G and B, with lossless compression. `values` are R, G, B with
// row 0 on top; rows are `line_values` apart. Uses the heap even when memory is sealed: no device has the library. Only
// if has_exr().
Status encode_exr(const float* values, int width, int height, std::size_t line_values, const ByteSink& sink);

}  // namespace pocketray
