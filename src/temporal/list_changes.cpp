// Lists the pixels to trace, as spans.
#include <algorithm>

#include "base/check.h"
#include "temporal/coherence.h"

namespace pocketray {

std::uint32_t list_changes(const Coherence& c, std::uint32_t row, std::uint32_t begin, std::uint32_t end, Span* spans) {
  CHECK_LT(row, c.plan.height);
  CHECK(begin <= end && end <= c.plan.width);
  const std::uint64_t* tiles = c.changed.data + std::size_t(row / kChangeTileSide) * c.tile_columns;
  const std::uint32_t shift = row % kChangeTileSide * 8;
  std::uint32_t count = 0;
  bool open = false;
  for (std::uint32_t column = begin; column < end;) {
    const std::uint32_t bits = tiles[column / kChangeTileSide] >> shift & 0xFF;
    const std::uint32_t tile_end = std::min(end, (column / kChangeTileSide + 1) * kChangeTileSide);
    if (bits == 0) {
      open = false;
      column = tile_end;
      continue;
    }
    for (; column < tile_end; ++column) {
      if (!(bits >> (column % kChangeTileSide) & 1)) {
        open = false;
      } else if (open) {
        ++spans[count - 1].column_end;
      } else {
        spans[count++] = {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
                          static_cast<std::uint16_t>(column + 1)};
        open = true;
      }
    }
  }
  return count;
}

std::uint32_t list_changes(const Coherence& c, std::uint32_t tile_row, Span* spans) {
  CHECK_LT(tile_row, c.tile_rows);
  const std::uint32_t end = std::min((tile_row + 1) * kChangeTileSide, c.plan.height);
  std::uint32_t count = 0;
  for (std::uint32_t row = tile_row * kChangeTileSide; row < end; ++row)
    count += list_changes(c, row, 0, c.plan.width, spans + count);
  return count;
}

std::uint32_t count_changes(const Coherence& c, std::uint32_t row) {
  CHECK_LT(row, c.plan.height);
  const std::uint64_t* tiles = c.changed.data + std::size_t(row / kChangeTileSide) * c.tile_columns;
  int count = 0;
  for (std::uint32_t i = 0; i < c.tile_columns; ++i)
    count += __builtin_popcountll(tiles[i] >> (row % kChangeTileSide * 8) & 0xFF);
  return static_cast<std::uint32_t>(count);
}

}  // namespace pocketray
