// Point sets that represent a square: a pixel, or the area of a light. They are evenly spread, and their mean is the
// centre for every count, so that neither pictures nor lights shift with the count.
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

// Point `index` of `count` (at most kSampleCountMax) in the unit square, optimized for edges. Each of `count` columns
// and rows has one point in its middle (n-rooks [Shirley 1991, "Discrepancy as a Quality Measure for Sample
// Distributions", sec. 4]): horizontal and vertical edges, the most common and most visible ones, get as many grey
// levels as there are points. Among all such sets, it has the least error for edges in any direction.
Vec2 rook_point(std::uint32_t index, std::uint32_t count);

// A cell of the unit square: its horizontal extent, the middle of its rows, and its height.
struct UnitCell {
  double x_begin, x_end, y, height;
};
// Cell `index` of `count` cells of equal area that tile the unit square: round(√count) rows of equal cells, the numbers
// per row differing by at most one. A square number gives a grid. Sums over the centroids of the cells are exact for
// functions that are linear over each cell.
UnitCell equal_cell(std::uint32_t index, std::uint32_t count);

}  // namespace pocketray
