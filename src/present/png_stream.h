// Parts shared by still and animated PNG files.
#pragma once
#include "base/arena.h"
#include "base/status.h"
#include "present/changed_pixels.h"
#include "present/image_file.h"

namespace pocketray {

void put_big_endian(std::uint32_t value, std::uint8_t* bytes);
// Writes a chunk [PNG 3rd edition, sec. 5.3]: length, type, data, and the CRC of type and data.
void write_png_chunk(const ByteSink& sink, const char* type, const std::uint8_t* data, std::size_t count);
// Writes the signature and the first chunks: 8 bits of R, G and B, marked as sRGB.
void write_png_head(const ByteSink& sink, int width, int height);

// Writes the compressed pixels of a box of a picture whose rows are `row_bytes` apart, as IDAT chunks. With a sequence
// number, as fdAT chunks, which increment it. Releases the arena to its previous mark; fails if it is too small.
std::size_t png_pixels_need(int width);
Status write_png_pixels(const ByteSink& sink, const std::uint8_t* rgb, std::size_t row_bytes, const PixelBox& box,
                        std::uint32_t* sequence, Arena* arena);

}  // namespace pocketray
