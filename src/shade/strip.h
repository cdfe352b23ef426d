// TileStrip: the pixels of kTileRows rows as a row of 8 × 8 tiles, each with a mask of the pixels to trace, so that
// ragged spans and single pixels are traced in packets, too.
#pragma once
#include "base/limits.h"
#include "shade/trace_spans.h"

namespace pocketray {

constexpr std::uint32_t kTileSide = 8;
static_assert(kTileSide * kTileRows == 64, "a tile's mask has 64 bits");

struct TileStrip {
  std::uint32_t row, column;                      // of the first tile's first pixel
  std::uint32_t row_count;                        // up to the last row with a pixel, at most kTileRows
  std::uint32_t tile_count;                       // 0: no pixels
  std::uint64_t mask[kImageSideMax / kTileSide];  // per tile; bit m: pixel m in Morton order, column before row
};

// Makes a strip of spans that lie within kTileRows rows of the first one's row, in any order. They may overlap.
void make_strip(const Span* spans, std::uint32_t span_count, TileStrip* strip);

}  // namespace pocketray
