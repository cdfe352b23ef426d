#include "shade/strip.h"

#include <algorithm>

#include "base/check.h"

namespace pocketray {
namespace {

// Spreads the bits of a row's eight pixels, from the left, to their places in Morton order.
std::uint64_t spread_columns(std::uint32_t bits) {
  return (bits & 0x03) | (bits & 0x0C) << 2 | (bits & 0x30) << 12 | (bits & 0xC0) << 14;
}
std::uint32_t spread_row(std::uint32_t row) { return (row & 1) << 1 | (row & 2) << 2 | (row & 4) << 3; }

}  // namespace

void make_strip(const Span* spans, std::uint32_t span_count, TileStrip* strip) {
  CHECK(spans != nullptr || span_count == 0);
  std::uint32_t begin = kImageSideMax, end = 0;
  for (std::uint32_t i = 0; i < span_count; ++i) {
    if (spans[i].column_begin >= spans[i].column_end) continue;
    begin = std::min<std::uint32_t>(begin, spans[i].column_begin);
    end = std::max<std::uint32_t>(end, spans[i].column_end);
  }
  CHECK_LE(end, kImageSideMax);
  strip->tile_count = begin < end ? (end - begin + kTileSide - 1) / kTileSide : 0;
  CHECK_LE(strip->tile_count, kImageSideMax / kTileSide);
  if (strip->tile_count == 0) return;
  strip->row = spans[0].row, strip->column = begin, strip->row_count = 0;
  std::fill_n(strip->mask, strip->tile_count, 0);
  for (std::uint32_t i = 0; i < span_count; ++i) {
    const Span& span = spans[i];
    if (span.column_begin >= span.column_end) continue;
    const std::uint32_t row = span.row - strip->row, last = span.column_end - begin;
    CHECK_LT(row, kTileRows);
    strip->row_count = std::max(strip->row_count, row + 1);
    const std::uint32_t shift = spread_row(row);
    for (std::uint32_t column = span.column_begin - begin; column < last;) {
      std::uint32_t tile = column / kTileSide, next = std::min(last, (tile + 1) * kTileSide);
      std::uint32_t bits = (1u << (next - tile * kTileSide)) - (1u << (column - tile * kTileSide));
      strip->mask[tile] |= spread_columns(bits) << shift;
      column = next;
    }
  }
}

void align_tiles(const TileStrip& strip, AlignedTiles* tiles) {
  CHECK(tiles != nullptr);
  CHECK_LE(strip.row_count, kTileRows);
  const std::uint32_t left = strip.column % kTileSide, top = strip.row % kTileSide;
  tiles->column = strip.column - left, tiles->row = strip.row - top;
  tiles->tile_count = strip.tile_count ? strip.tile_count + (left > 0) : 0;
  for (std::uint64_t* row : tiles->mask) std::fill_n(row, tiles->tile_count, 0);
  if (left == 0 && top == 0) {
    std::copy_n(strip.mask, strip.tile_count, tiles->mask[0]);
    return;
  }
  for (std::uint32_t i = 0; i < strip.tile_count; ++i)
    for (std::uint64_t mask = strip.mask[i]; mask; mask &= mask - 1) {
      const auto m = static_cast<std::uint32_t>(__builtin_ctzll(mask));
      const std::uint32_t column = left + i * kTileSide + morton_column(m), row = top + morton_row(m);
      tiles->mask[row / kTileSide][column / kTileSide] |= std::uint64_t(1)
                                                          << morton_place(column % kTileSide, row % kTileSide);
    }
}

}  // namespace pocketray
