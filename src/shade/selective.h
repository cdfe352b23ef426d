// Selective rendering [Aranha07, sec. 3 and 5]: traces every fourth pixel of every fourth row, and of the others only
// those whose absence would be visible.
//
// A cell of 4 × 4 pixels whose corners show one plain surface at very low contrast is interpolated. In any other cell,
// camera rays find the edges; a pixel takes its light from corners on its own surface if they agree, and is shaded
// otherwise. On textures, the light is interpolated, not the colours.
//
// Cells have fixed places in the picture, and a pixel depends only on its own cell's corners: the picture does not
// depend on how it is divided.
#pragma once
#include "shade/cell.h"
#include "shade/lattice.h"
#include "shade/strip.h"

namespace pocketray {

static_assert(kTileSide == 2 * kCellSide, "a tile has 2 × 2 cells");

// Each thread keeps the corners below a row of tiles for the next row of tiles, in Tracer::corner_rows. Undersampling
// reads beyond its rows, so with it the corners in a tile's middle are kept as well.
constexpr std::uint32_t corner_count(std::uint32_t width) { return 2 * grid_side(width, kTileSide) + 1; }
constexpr std::uint32_t selective_corner_count(const Settings& settings) {
  return (plans_lattice(settings) ? 4 : 2) * corner_count(settings.width) * settings.threads;
}
inline std::size_t selective_need(const Settings& settings) {
  return arena_need<CellCorner>(selective_corner_count(settings));
}
// Gives a tracer its rows: two or four of corner_count() each, consecutive.
void keep_corner_rows(Array<CellCorner> rows, Tracer* tracer);

// Traces the strip's pixels.
void trace_selectively(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

}  // namespace pocketray
