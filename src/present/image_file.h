// Picture files without any library: PPM, PFM, raw pixels. Encoders write to a sink and take no memory. A sink
// remembers failures and reports them when it is closed.
#pragma once
#include <cstddef>
#include <cstdint>

namespace pocketray {

struct ByteSink {
  void (*write)(void* user, const void* bytes, std::size_t count);
  void* user;
};

// Portable pixmap, binary (P6): width × height pixels of bytes R, G, B, row 0 on top.
void encode_ppm(const std::uint8_t* rgb, int width, int height, const ByteSink& sink);

// Portable float map: linear values, 3 channels (PF: R, G, B) or 1 (Pf), little-endian, bottom row first as the format
// requires. `values` has row 0 on top; rows are `line_values` apart, 0: without padding.
void encode_pfm(const float* values, int channels, int width, int height, const ByteSink& sink,
                std::size_t line_values = 0);

// Pixels as on a screen, without padding between rows.
void encode_raw(const void* pixels, int row_bytes, int line_bytes, int rows, const ByteSink& sink);

}  // namespace pocketray
