// TileStrip: the pixels of kTileRows rows as a row of 8 × 8 tiles, each with a mask of the pixels to trace, so that
// ragged spans and single pixels are traced in packets, too.
#pragma once
#include "base/limits.h"
#include "shade/trace_spans.h"

namespace pocketray {

constexpr std::uint32_t kTileSide = 8;
static_assert(kTileSide * kTileRows == 64, "a tile's mask has 64 bits");

// Places in a tile: bits of column and row alternate, the column's first.
constexpr std::uint32_t morton_column(std::uint32_t m) { return (m & 1) | (m >> 1 & 2) | (m >> 2 & 4); }
constexpr std::uint32_t morton_row(std::uint32_t m) { return morton_column(m >> 1); }
constexpr std::uint32_t morton_place(std::uint32_t column, std::uint32_t row) {
  std::uint32_t m = 0;
  for (std::uint32_t b = 0; b < 3; ++b) m |= (column >> b & 1) << 2 * b | (row >> b & 1) << (2 * b + 1);
  return m;
}

// Columns of a packet in a strip of this many rows: several tiles side by side if there are few rows.
constexpr std::uint32_t packet_columns(std::uint32_t row_count) { return kTileSide * (kTileRows / row_count); }

// Consecutive rows of pixels, the first of which is row `first_row` of the picture.
struct PixelRows {
  Vec3* pixels;
  std::uint32_t width, first_row;

  Vec3& at(std::uint32_t column, std::uint32_t row) const {
    return pixels[static_cast<std::size_t>(row - first_row) * width + column];
  }
};

struct TileStrip {
  std::uint32_t row, column;                      // of the first tile's first pixel
  std::uint32_t row_count;                        // up to the last row with a pixel, at most kTileRows
  std::uint32_t tile_count;                       // 0: no pixels
  std::uint64_t mask[kImageSideMax / kTileSide];  // per tile; bit m: pixel m in Morton order, column before row
};

// Makes a strip of spans that lie within kTileRows rows of the first one's row, in any order. They may overlap.
void make_strip(const Span* spans, std::uint32_t span_count, TileStrip* strip);

// The strip's pixels regrouped into tiles aligned to multiples of eight; the strip spans up to two rows of these.
struct AlignedTiles {
  std::uint32_t column, row;  // of the first tile's first pixel
  std::uint32_t tile_count;   // in each row
  std::uint64_t mask[2][kImageSideMax / kTileSide + 1];
};
void align_tiles(const TileStrip& strip, AlignedTiles* tiles);

}  // namespace pocketray
