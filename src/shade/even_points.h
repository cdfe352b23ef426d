// Sets of points that stand for a square: for a pixel, or for the area of a light. They are spread evenly, and their
// mean is the centre whatever their number, so that neither pictures nor lights move with it.
#pragma once
#include <cstdint>

#include "base/vec3.h"

namespace pocketray {

// Point `index` of `count`, at most kSampleCountMax, in the unit square, for what edges cut. Each of `count` columns
// and each of as many rows has one point in its middle (n-rooks [Shirley 1991, "Discrepancy as a Quality Measure for
// Sample Distributions", sec. 4]): level and upright edges, the most common and the most visible ones, get as many grey
// levels as there are points. Of all such sets it is one that errs least for edges in any direction.
Vec2 rook_point(std::uint32_t index, std::uint32_t count);

// A cell of the unit square, x_begin … x_end wide, and the middle of its height.
struct Cell {
  double x_begin, x_end, y;
};
// Cell `index` of `count` of equal area, which fill the unit square: round(√count) rows of like cells, as many in one
// row as in another or one more. A square number gives a grid. Sums over the centroids of the cells are exact for what
// is linear over each cell.
Cell equal_cell(std::uint32_t index, std::uint32_t count);

}  // namespace pocketray
