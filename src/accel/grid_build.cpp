// Builds the root grid. Grids below it are made on demand by rays: grid_subdivide.cpp.
#include <new>

#include "accel/grid_pool.h"
#include "accel/grid_shape.h"
#include "accel/triangle.h"
#include "base/check.h"

namespace pocketray {
namespace {

constexpr std::uint64_t root_words_max(std::uint64_t triangles) {
  return grid_words(triangles * kRootCellsPerTriangle + 1, triangles * kRootIdsPerTriangle);
}
static_assert((kRootPlace + root_words_max(kTriangleCountMax) +
               kPoolWordsPerTriangle * std::uint64_t(kTriangleCountMax) + kPoolWordsMin) *
                          4 +
                      2 * kArenaAlignment <=
                  0xFFFFFFFFu,
              "fits into a 32-bit address space");

// Bounds of every triangle with valid vertices, as all accelerators report them; ids and bounds of the triangles that
// rays can hit.
struct Content {
  Array<std::uint32_t> ids;
  Box bounds, hittable;
};

Content find_content(const Accel& accel, Arena* scratch) {
  Content content = {arena_array<std::uint32_t>(scratch, accel.triangles.count), empty_box(), empty_box()};
  content.ids.count = 0;
  for (std::uint32_t id = 0; id < accel.triangles.count; ++id) {
    if (!has_valid_vertices(accel.positions, accel.triangles[id])) continue;
    Box box = triangle_box(accel, id);
    content.bounds = merge(content.bounds, box);
    if (!is_hittable(accel.positions, accel.triangles[id])) continue;
    content.hittable = merge(content.hittable, box);
    content.ids.data[content.ids.count++] = id;
  }
  return content;
}

// Box of the root grid: slightly larger on either side, by unequal amounts. Models have planes at round fractions of
// their size; without this, these coincide with the faces of voxels and lie in the voxels on both sides.
Box root_box(const Box& bounds) {
  if (is_empty(bounds)) return {{0, 0, 0}, {0, 0, 0}};
  Box box = bounds;
  for (int axis = 0; axis < 3; ++axis) {
    double e = double(bounds.high[axis]) - double(bounds.low[axis]);
    float low = static_cast<float>(bounds.low[axis] - e * 0.0071),
          high = static_cast<float>(bounds.high[axis] + e * 0.0113);
    box.low[axis] = low < bounds.low[axis] ? low : bounds.low[axis];
    box.high[axis] = high > bounds.high[axis] ? high : bounds.high[axis];
  }
  return box;
}

}  // namespace

std::size_t grid_need(std::uint32_t triangle_count, std::uint64_t pool_words) {
  return arena_need((kRootPlace + root_words_max(triangle_count) + pool_words) * 4);
}

void grid_build(Accel* accel, Arena* keep, Arena* scratch, std::uint64_t pool_words) {
  CHECK(keep != scratch);  // each is released to its own mark
  CHECK_LE(accel->triangles.count, kTriangleCountMax);
  std::uint32_t n = accel->triangles.count;
  std::size_t scratch_mark = arena_mark(*scratch);
  Content content = find_content(*accel, scratch);
  GridShape shape;
  GridLimits limits = {std::uint64_t(n) * kRootCellsPerTriangle + 1, std::uint64_t(n) * kRootIdsPerTriangle};
  std::uint64_t id_count = choose_shape(*accel, content.ids, root_box(content.hittable), limits, &shape);
  std::uint64_t root_words = grid_words(cell_count_of(shape), id_count);
  CHECK_LE(root_words, root_words_max(n));
  std::uint32_t bytes = static_cast<std::uint32_t>((kRootPlace + root_words + pool_words) * 4);
  accel->data = {static_cast<std::uint8_t*>(arena_allocate(keep, bytes)), bytes};
  accel->bounds = content.bounds;

  Grid grid(*accel);
  new (grid.words) GridHeader();
  GridHeader& header = grid.header();
  header.magic = kGridMagic, header.triangle_count = n;
  GridNode* root = new (&grid.node(kRootPlace)) GridNode();
  root->shape = shape;
  fill_cells(*accel, content.ids, root);
  std::uint32_t pool_begin = kRootPlace + static_cast<std::uint32_t>(root_words);
  make_pool(grid, pool_begin, pool_begin + static_cast<std::uint32_t>(pool_words));
  arena_release(scratch, scratch_mark);
}

}  // namespace pocketray
