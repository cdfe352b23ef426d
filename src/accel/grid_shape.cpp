#include "accel/grid_shape.h"

#include <new>

#include "base/check.h"

namespace pocketray {
namespace {

// Below this, an extent counts as none: its cells would be thinner than any ray's padding (grid_walk.h).
constexpr double kExtentMin = 0x1p-100;

struct CellRange {
  std::uint32_t first[3], last[3];
};

CellRange cells_of_box(const GridShape& shape, const Box& box) {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    range.first[axis] = cell_of(shape, axis, double(box.low[axis]));
    range.last[axis] = cell_of(shape, axis, double(box.high[axis]));
  }
  return range;
}

Vec3d absolute(const Vec3d& a) { return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}; }
double sum_of(const Vec3d& a) { return a.x + a.y + a.z; }

// The plane of a triangle against cells of a grid, all of one size.
struct PlaneTest {
  Vec3d corner, normal, half;  // half: half a cell, with room for the errors of cell_begin() and cell_of()
  double reach, error;         // distance within which the plane meets a cell; relative error of a distance

  PlaneTest(const GridShape& shape, const Vec3& a, const Vec3& b, const Vec3& c) : corner(to_double(a)) {
    Vec3d ab = to_double(b) - corner, ac = to_double(c) - corner;
    normal = cross(ab, ac);
    for (int axis = 0; axis < 3; ++axis) half[axis] = double(shape.size[axis]) * (0.5 + shape.cells[axis] * 0x1p-20);
    reach = dot(absolute(normal), half);
    error = sum_of(absolute(ab)) * sum_of(absolute(ac)) * 0x1p-48;
  }
  bool meets(const GridShape& shape, std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    Vec3d middle = {(x + 0.5) * shape.size[0] + shape.low[0], (y + 0.5) * shape.size[1] + shape.low[1],
                    (z + 0.5) * shape.size[2] + shape.low[2]};
    Vec3d offset = middle - corner;
    return std::fabs(dot(normal, offset)) <= reach + error * (sum_of(absolute(offset)) + sum_of(half));
  }
};

// Visits the cells whose list must contain a triangle: those that its box touches and, if many, its plane too.
template <class Visit>
void for_each_cell(const Accel& accel, const GridShape& shape, std::uint32_t triangle, Visit visit) {
  CellRange r = cells_of_box(shape, triangle_box(accel, triangle));
  std::uint32_t nx = r.last[0] - r.first[0] + 1, ny = r.last[1] - r.first[1] + 1, nz = r.last[2] - r.first[2] + 1;
  if (nx == 1 && ny == 1 && nz == 1) return visit(cell_number(shape, r.first[0], r.first[1], r.first[2]));
  const Triangle& t = accel.triangles[triangle];
  PlaneTest plane(shape, accel.positions[t.vertex(0)], accel.positions[t.vertex(1)], accel.positions[t.vertex(2)]);
  bool is_flat = nx == 1 || ny == 1 || nz == 1;
  for (std::uint32_t z = r.first[2]; z <= r.last[2]; ++z)
    for (std::uint32_t y = r.first[1]; y <= r.last[1]; ++y)
      for (std::uint32_t x = r.first[0]; x <= r.last[0]; ++x)
        if (is_flat || plane.meets(shape, x, y, z)) visit(cell_number(shape, x, y, z));
}

// Stops counting beyond the limit, between triangles.
std::uint64_t count_ids(const Accel& accel, Array<const std::uint32_t> ids, const GridShape& shape,
                        std::uint64_t limit) {
  std::uint64_t count = 0;
  for (std::uint32_t id : ids) {
    for_each_cell(accel, shape, id, [&](std::uint32_t) { ++count; });
    if (count > limit) break;
  }
  return count;
}

// Makes cells as nearly cubic as whole numbers allow [Fujimoto et al. 1986, ARTS], at most `cell_count`: their edge
// shrinks by steps of an eighth. No cube root: pictures do not depend on it, but the work counted per pixel does.
void divide_box(const Box& box, std::uint64_t cell_count, GridShape* shape) {
  double extents[3], edge = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double e = double(box.high[axis]) - double(box.low[axis]);
    CHECK_GE(e, 0);
    extents[axis] = e >= kExtentMin ? e : 0;
    if (extents[axis] > edge) edge = extents[axis];
    shape->cells[axis] = 1;
  }
  while (edge > 0) {
    edge *= 0.875;
    std::uint64_t cells[3], product = 1;
    for (int axis = 0; axis < 3; ++axis) {
      double n = extents[axis] / edge + 0.5;
      cells[axis] = n < 1 ? 1 : n < kCellsPerAxisMax ? static_cast<std::uint64_t>(n) : kCellsPerAxisMax + 1;
      product *= cells[axis];
      if (cells[axis] > kCellsPerAxisMax) return;
    }
    if (product > cell_count) return;
    for (int axis = 0; axis < 3; ++axis) shape->cells[axis] = static_cast<std::uint16_t>(cells[axis]);
  }
}

void place_cells(const Box& box, GridShape* shape) {
  for (int axis = 0; axis < 3; ++axis) {
    double extent = double(box.high[axis]) - double(box.low[axis]), cells = shape->cells[axis];
    shape->low[axis] = box.low[axis];
    shape->size[axis] = static_cast<float>(extent / cells);
    shape->inverse[axis] = shape->cells[axis] > 1 ? static_cast<float>(cells / extent) : 0;
  }
}

}  // namespace

Box triangle_box(const Accel& accel, std::uint32_t triangle) {
  CHECK_LT(triangle, accel.triangles.count);
  const Triangle& t = accel.triangles[triangle];
  Box box = empty_box();
  for (std::uint32_t vertex : t.vertices()) box = merge(box, accel.positions[vertex]);
  return box;
}

Box cell_box(const GridShape& shape, std::uint32_t cell) {
  std::uint32_t at[3] = {cell % shape.cells[0], cell / shape.cells[0] % shape.cells[1],
                         cell / shape.cells[0] / shape.cells[1]};
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    // The error of cell_begin() and of cell_of(), and rounding to float.
    double slack = shape.cells[axis] * double(shape.size[axis]) * 0x1p-22;
    double low = cell_begin(shape, axis, at[axis]) - slack, high = cell_begin(shape, axis, at[axis] + 1) + slack;
    float a = static_cast<float>(low), b = static_cast<float>(high);
    box.low[axis] = double(a) > low ? std::nextafter(a, -std::numeric_limits<float>::infinity()) : a;
    box.high[axis] = double(b) < high ? std::nextafter(b, std::numeric_limits<float>::infinity()) : b;
  }
  return box;
}

std::uint64_t choose_shape(const Accel& accel, Array<const std::uint32_t> ids, const Box& box, const GridLimits& limits,
                           GridShape* shape) {
  CHECK_LE(ids.count, limits.id_count);
  for (std::uint64_t cells = limits.cell_count;; cells /= 2) {
    divide_box(box, cells, shape);
    place_cells(box, shape);
    std::uint64_t count = count_ids(accel, ids, *shape, limits.id_count);
    if (count <= limits.id_count) return count;
    CHECK_GT(cells, 1u);  // one cell holds each triangle once
  }
}

void fill_cells(const Accel& accel, Array<const std::uint32_t> ids, GridNode* node) {
  const GridShape& shape = node->shape;
  std::uint32_t cell_count = cell_count_of(shape), sum = 0;
  GridCell* cells = cells_of(*node);
  std::uint32_t* list = ids_of(*node);
  for (std::uint32_t i = 0; i <= cell_count; ++i) new (&cells[i]) GridCell{0, {kNotSubdivided}};
  for (std::uint32_t id : ids) for_each_cell(accel, shape, id, [&](std::uint32_t cell) { ++cells[cell].begin; });
  for (std::uint32_t i = 0; i <= cell_count; ++i) {
    std::uint32_t count = cells[i].begin;
    cells[i].begin = sum, sum += count;
  }
  // Filling moves every cell's begin to its end, which is where the next one begins.
  for (std::uint32_t id : ids)
    for_each_cell(accel, shape, id, [&](std::uint32_t cell) { list[cells[cell].begin++] = id; });
  for (std::uint32_t i = cell_count; i > 0; --i) cells[i].begin = cells[i - 1].begin;
  cells[0].begin = 0;
}

}  // namespace pocketray
