// OpenEXR, in builds with its library.
#pragma once
#include <vector>

#include "base/status.h"
#include "base/vec3.h"
#include "present/image_file.h"

namespace pocketray {

bool has_exr();
// Writes linear values as 32-bit floats in channels R, G and B, with lossless compression. `values` are R, G, B with
// row 0 on top; rows are `line_values` apart. Uses the heap even when memory is sealed: no device has the library. Only
// if has_exr().
Status encode_exr(const float* values, int width, int height, std::size_t line_values, const ByteSink& sink);

// Decodes the first part of a file, whatever it holds: channels R, G and B, or Y as all three, of 16-bit or 32-bit
// floats, in scanlines or tiles; row 0 on top. Takes memory as rows are decoded, so a small file costs little. Refuses
// more than `pixel_count_max` pixels; the message continues the file's name. Only if has_exr().
Status decode_exr(const std::uint8_t* bytes, std::size_t byte_count, std::size_t pixel_count_max, std::uint32_t* width,
                  std::uint32_t* height, std::vector<Vec3>* pixels);

}  // namespace pocketray
