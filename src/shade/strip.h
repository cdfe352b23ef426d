// TileStrip: pixels of kTileRows rows as a row of 8 × 8 tiles, each with a mask of the pixels that are to be traced. So
// ragged spans and lone pixels are traced in packets, too.
#pragma once
#include "base/limits.h"
#include "shade/trace_spans.h"

namespace pocketray {

constexpr std::uint32_t kTileSide = 8;
static_assert(kTileSide * kTileRows == 64, "a tile's mask has 64 bits");

struct TileStrip {
  std::uint32_t row, column;                      // of the first tile's first pixel
  std::uint32_t row_count;                        // from there to the last row that has a pixel, at most kTileRows
  std::uint32_t tile_count;                       // 0: there are no pixels
  std::uint64_t mask[kImageSideMax / kTileSide];  // of each tile; bit m: pixel m in Morton order, column before row
};

// The strip of spans that lie within kTileRows rows from the first one's row on, in any order. They may overlap.
void make_strip(const Span* spans, std::uint32_t span_count, TileStrip* strip);

}  // namespace pocketray
