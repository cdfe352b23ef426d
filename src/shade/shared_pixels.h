// Light that pixels share with their neighbours (interleaved.h), kept in a window so that further samples of a pixel
// take it from pixels around it on their surface instead of tracing rays of their own.
#pragma once
#include "shade/interleaved.h"

namespace pocketray {

// A pixel with the sums of light on its surface; their surface's light is few if only the unshadowed share counts.
struct SharedPixel {
  InterleavedPixel pixel;  // triangle kNone: it shares none
  bool are_few[kInterleavedSourceCount];
};

// Returns whether the window keeps shared light. None is kept of previews, which are coarser than the picture.
inline bool is_shared(const PixelWindow& window) { return window.shared.count > 0 && window.row != ~0u; }
// Returns the slot of a pixel in the tracer's window; null: none is kept.
SharedPixel* shared_pixel(Tracer* tracer, std::uint32_t column, std::uint32_t row);

// Adds the shared light to a surface that a sample of the pixel hits, from the first of the 3 × 3 pixels around it that
// shows the surface; if none does, by the visible share of the pixel's own sources.
void take_shared_light(Tracer* tracer, std::uint32_t column, std::uint32_t row, Surface* surface);

}  // namespace pocketray
