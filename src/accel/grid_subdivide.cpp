#include "accel/grid_subdivide.h"

#include <new>

#include "accel/grid_pool.h"
#include "accel/grid_shape.h"
#include "base/check.h"

namespace pocketray {
namespace {

Box overlap(const Box& a, const Box& b) { return {max(a.low, b.low), min(a.high, b.high)}; }

// Returns the part of the voxel covered by its triangles' boxes.
Box content_box(const Accel& accel, const GridShape& shape, std::uint32_t cell, Array<const std::uint32_t> ids) {
  Box box = empty_box();
  for (std::uint32_t id : ids) box = merge(box, triangle_box(accel, id));
  box = overlap(box, cell_box(shape, cell));
  CHECK(!is_empty(box));
  return box;
}

// Returns whether the grid is expected to cost a ray less than the voxel's triangles. A ray along a random line crosses
// about half as many cells as there are slices along all axes, and a visit counts as half a triangle test.
bool is_worth_it(const GridShape& shape, std::uint64_t id_count, std::uint32_t triangle_count) {
  double cells = cell_count_of(shape), slices = shape.cells[0] + shape.cells[1] + shape.cells[2];
  return cells > 1 && slices / 2 * (static_cast<double>(id_count) / cells + 0.5) < triangle_count;
}

std::uint32_t make_grid(const Accel& accel, std::uint32_t parent, std::uint32_t cell) {
  Grid grid(accel);
  GridNode& above = grid.node(parent);
  GridCell* cells = cells_of(above);
  CHECK_LT(cell, cell_count_of(above.shape));
  CHECK_LT(above.depth, kGridDepthMax);
  Array<const std::uint32_t> ids = {ids_of(above) + cells[cell].begin, cells[cell + 1].begin - cells[cell].begin};
  GridLimits limits = {std::uint64_t(ids.count) * kCellsPerTriangle, std::uint64_t(ids.count) * kIdsPerTriangle};
  GridShape shape;
  std::uint64_t id_count = choose_shape(accel, ids, content_box(accel, above.shape, cell, ids), limits, &shape);
  std::uint32_t cell_count = cell_count_of(shape);
  if (!is_worth_it(shape, id_count, ids.count)) return kSubdividedWithoutGrid;
  std::uint32_t place = take_block(grid, parent, grid_words(cell_count, id_count));
  if (!place) return kNotSubdivided;
  std::uint32_t block = grid.node(place).block;
  GridNode* node = new (&grid.node(place)) GridNode();
  node->block = block, node->parent = parent, node->cell = cell, node->shape = shape;
  node->depth = static_cast<std::uint16_t>(above.depth + 1);
  node->stamp.store(grid.header().clock.load(std::memory_order_relaxed), std::memory_order_relaxed);
  fill_cells(accel, ids, node);
  ++grid.header().grid_count;
  return place;
}

}  // namespace

std::uint32_t subdivide(const Accel& accel, std::uint32_t parent, std::uint32_t cell) {
  Grid grid(accel);
  if (!try_lock(&grid.header())) return kNotSubdivided;
  std::atomic<std::uint32_t>& child = cells_of(grid.node(parent))[cell].child;
  std::uint32_t place = child.load(std::memory_order_relaxed);
  if (place == kNotSubdivided && !is_resting(&grid.header())) {
    place = make_grid(accel, parent, cell);
    child.store(place, std::memory_order_release);
  }
  unlock(&grid.header());
  return place;
}

}  // namespace pocketray
