// The shape of a grid for a list of triangles, and the lists of its cells.
#pragma once
#include "accel/grid.h"
#include "base/box.h"

namespace pocketray {

Box triangle_box(const Accel& accel, std::uint32_t triangle);
// Bounds of a cell, rounded outwards.
Box cell_box(const GridShape& shape, std::uint32_t cell);

// Limits of a grid over some triangles.
struct GridLimits {
  std::uint64_t cell_count, id_count;
};

// Divides the box into about limits.cell_count cells, fewer if the lists would exceed limits.id_count ids. Returns the
// total number of ids. One cell always takes one id per triangle.
std::uint64_t choose_shape(const Accel& accel, Array<const std::uint32_t> ids, const Box& box, const GridLimits& limits,
                           GridShape* shape);
// Makes the cells of a node whose shape is set, none of them subdivided, and their lists.
void fill_cells(const Accel& accel, Array<const std::uint32_t> ids, GridNode* node);

}  // namespace pocketray
