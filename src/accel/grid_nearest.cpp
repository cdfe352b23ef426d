// Distance from a point to the nearest triangle: the voxels of the root grid whose distance is less than the least so
// far.
#include <limits>

#include "accel/grid_shape.h"
#include "accel/point_distance.h"
#include "base/check.h"

namespace pocketray {
namespace {

double squared_box_distance(const Vec3d& p, const Box& box, double slack) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double below = box.low[axis] - p[axis], above = p[axis] - box.high[axis];
    double d = (below > above ? below : above) - slack;
    if (d > 0) sum += d * d;
  }
  return sum;
}

double squared_triangle_distance(const Accel& accel, std::uint32_t id, const Vec3d& p) {
  const Triangle& t = accel.triangles[id];
  return squared_distance(p, to_double(accel.positions[t.vertex(0)]), to_double(accel.positions[t.vertex(1)]),
                          to_double(accel.positions[t.vertex(2)]));
}

}  // namespace

float grid_nearest_distance(const Accel& accel, const Vec3& point) {
  if (!is_finite(point)) return 0;
  CHECK_LE(sizeof(GridHeader) + sizeof(GridNode), accel.data.bytes());
  GridNode& root = Grid(accel).node(kRootPlace);
  const GridCell* cells = cells_of(root);
  const std::uint32_t* ids = ids_of(root);
  Vec3d p = to_double(point);
  // squared_distance() may err by as much as distance_bound() allows for; the least must be that of brute force.
  double slack = is_empty(accel.bounds) ? 0 : double(max_component(extent(accel.bounds))) * 0x1p-20;
  double least = std::numeric_limits<double>::infinity();
  auto visit = [&](std::uint32_t cell) {
    if (cells[cell].begin == cells[cell + 1].begin) return;
    if (squared_box_distance(p, cell_box(root.shape, cell), slack) > least) return;
    for (std::uint32_t i = cells[cell].begin; i < cells[cell + 1].begin; ++i) {
      double d = squared_triangle_distance(accel, ids[i], p);
      if (d < least) least = d;
    }
  };
  // The point's own voxel first: its triangles rule out most others.
  visit(cell_number(root.shape, cell_of(root.shape, 0, p.x), cell_of(root.shape, 1, p.y), cell_of(root.shape, 2, p.z)));
  for (std::uint32_t cell = 0; cell < cell_count_of(root.shape); ++cell) visit(cell);
  return distance_bound(least, accel.bounds);
}

}  // namespace pocketray
