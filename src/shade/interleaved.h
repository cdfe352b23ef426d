// Interleaved sampling of virtual lights [Keller & Heidrich 2001; Wald et al. 2002]: in blocks of 4 × 4 pixels, each
// pixel traces shadow rays to a sixteenth of the lights, and takes the mean of the block's pixels on the same surface.
// Blocks have fixed places in the picture, and a pixel depends on its own block alone: whichever pixels are asked for,
// the rest of their blocks is traced, too, and the picture does not depend on how it is divided.
#pragma once
#include "shade/strip.h"
#include "shade/surface.h"

namespace pocketray {

constexpr std::uint32_t kBlockSide = 4, kBlockPixels = kBlockSide * kBlockSide;

// Irradiance of the virtual lights on the first hits of up to four blocks. `place` is a pixel's position in Morton
// order, ascending; pixels that hit nothing have no triangle.
struct BlockHits {
  std::uint32_t count;
  const std::uint8_t* place;
  const Surface* surface;
  const Hit* hits;
};
void gather_virtual_light(const FrameData& frame, const BlockHits& pixels, TraceStats* stats, std::uint64_t* rays,
                          Vec3* irradiance);

// Traces the strip's pixels.
void trace_interleaved(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

}  // namespace pocketray
