#include "accel/grid_walk.h"

#include <algorithm>

#include "accel/grid_subdivide.h"
#include "base/check.h"

namespace pocketray {
namespace {

// Farthest distance of a hit at t. t may be rounded by half of the least denormal.
double distance_at(const GridWalk& walk, float t) {
  return (double(t) + double(std::numeric_limits<float>::denorm_min())) * walk.speed;
}

template <bool kAny>
bool test_triangles(GridWalk* w, const std::uint32_t* ids, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t id = ids[i], *tested = &w->tested[id % kMailboxSize];
    if (*tested == id) continue;
    *tested = id;
    if (kAny && (id == w->from || id == w->to)) continue;
    if (w->stats) ++w->stats->triangles;
    const Triangle& triangle = w->accel.triangles[id];
    Hit hit;
    if (!intersect_triangle(w->ray, w->accel.positions[triangle.vertex(0)], w->accel.positions[triangle.vertex(1)],
                            w->accel.positions[triangle.vertex(2)], &hit))
      continue;
    if (!(hit.t > 0 && hit.t < w->t_max)) continue;
    if (w->hit.triangle != kNoTriangle && !(hit.t < w->hit.t || (hit.t == w->hit.t && id < w->hit.triangle))) continue;
    if (w->filter && w->filter->accept && !w->filter->accept(w->filter->context, id, hit.u, hit.v)) continue;
    w->hit = hit;
    w->hit.triangle = id;
    if (kAny) return true;
    w->limit = distance_at(*w, hit.t);
  }
  return false;
}

// Shortens a range of distances to the part where the ray is within the grid along a minor axis, padded twice: the
// division loses less than that by cancellation. Returns false if the range is empty.
bool clip_to_grid(const GridWalk& w, const GridShape& shape, int axis, double* from, double* to) {
  double low = double(shape.low[axis]) - 2 * w.padding - w.origin[axis];
  double high = cell_begin(shape, axis, shape.cells[axis]) + 2 * w.padding - w.origin[axis];
  // Within the scene, a ray that is nearly parallel strays by less than its padding.
  if (w.inverse_slope[axis] == 0) return low <= 0 && high >= 0;
  double a = low * w.inverse_slope[axis], b = high * w.inverse_slope[axis];
  *from = std::max(*from, std::min(a, b)), *to = std::min(*to, std::max(a, b));
  return *from <= *to;
}

// A minor axis of a grid, in cells instead of coordinates: the ray's position at a distance.
struct CellTrack {
  double start, rate, padding;
  std::uint32_t last;

  CellTrack(const GridWalk& w, const GridShape& shape, int axis) : last(shape.cells[axis] - 1u) {
    double inverse = double(shape.inverse[axis]);
    start = (w.origin[axis] - double(shape.low[axis])) * inverse, rate = w.slope[axis] * inverse;
    padding = 2 * w.padding * inverse;  // sideways, and along the ray, over which it strays by no more
  }
  double at(double distance) const { return start + distance * rate; }
  std::uint32_t cell(double place) const {
    return place > 0 ? place < last ? static_cast<std::uint32_t>(place) : last : 0;
  }
  std::uint32_t first_of(double a, double b) const { return cell(std::min(a, b) - padding); }
  std::uint32_t last_of(double a, double b) const { return cell(std::max(a, b) + padding); }
};

template <bool kAny>
bool walk_grid(GridWalk* w, std::uint32_t place, double from, double to);

template <bool kAny>
bool visit_cell(GridWalk* w, std::uint32_t place, GridNode& node, std::uint32_t cell, double from, double to) {
  if (w->stats) ++w->stats->nodes;
  GridCell* cells = cells_of(node);
  std::uint32_t begin = cells[cell].begin, count = cells[cell + 1].begin - begin;
  if (count == 0) return false;
  if (count > kVoxelTriangleMax && node.depth < kGridDepthMax) {
    std::uint32_t child = cells[cell].child.load(std::memory_order_acquire);
    if (child == kNotSubdivided) child = subdivide(w->accel, place, cell);
    if (child > kSubdividedWithoutGrid) return walk_grid<kAny>(w, child, from, to);
  }
  return test_triangles<kAny>(w, ids_of(node) + begin, count);
}

// Visits all voxels of a grid that the ray touches between two distances, nearer slices first.
template <bool kAny>
bool walk_grid(GridWalk* w, std::uint32_t place, double from, double to) {
  GridNode& node = w->grid.node(place);
  const GridShape& shape = node.shape;
  if (node.stamp.load(std::memory_order_relaxed) != w->clock) node.stamp.store(w->clock, std::memory_order_relaxed);
  const int m = w->main, u = w->minor[0], v = w->minor[1];
  auto distance_of = [&](double x) { return (x - w->origin[m]) * w->sign; };
  double low = distance_of(double(shape.low[m])), high = distance_of(cell_begin(shape, m, shape.cells[m]));
  from = std::max(from, std::min(low, high) - w->padding), to = std::min(to, std::max(low, high) + w->padding);
  if (!(from <= to) || !clip_to_grid(*w, shape, u, &from, &to) || !clip_to_grid(*w, shape, v, &from, &to)) return false;
  const int step = w->sign > 0 ? 1 : -1;
  const std::uint32_t far_face = w->sign > 0 ? 1 : 0;
  std::uint32_t first = cell_of(shape, m, w->origin[m] + from * w->sign);
  std::uint32_t last = cell_of(shape, m, w->origin[m] + to * w->sign);
  const CellTrack u_track(*w, shape, u), v_track(*w, shape, v);
  std::uint32_t at[3];
  double near = from, u_near = u_track.at(near), v_near = v_track.at(near);
  for (at[m] = first;; at[m] += static_cast<std::uint32_t>(step)) {
    if (near - w->padding > w->limit) return false;  // so are all further slices; a hit of equal t may lie in this one
    double far = to;
    if (at[m] != last) far = std::min(to, distance_of(cell_begin(shape, m, at[m] + far_face)));
    double u_far = u_track.at(far), v_far = v_track.at(far);
    std::uint32_t u_first = u_track.first_of(u_near, u_far), u_last = u_track.last_of(u_near, u_far);
    std::uint32_t v_first = v_track.first_of(v_near, v_far), v_last = v_track.last_of(v_near, v_far);
    for (at[v] = v_first; at[v] <= v_last; ++at[v])
      for (at[u] = u_first; at[u] <= u_last; ++at[u])
        if (visit_cell<kAny>(w, place, node, cell_number(shape, at[0], at[1], at[2]), near - w->padding,
                             far + w->padding))
          return true;
    if (at[m] == last) return false;
    near = far, u_near = u_far, v_near = v_far;
  }
}

double reach_of(const Box& bounds, const double (&origin)[3]) {
  double reach = 0;
  for (int axis = 0; axis < 3; ++axis)
    reach = std::max(reach,
                     std::max(std::fabs(bounds.low[axis] - origin[axis]), std::fabs(bounds.high[axis] - origin[axis])));
  return reach;
}

}  // namespace

bool start_walk(const Ray& ray, const HitFilter* filter, TraceStats* stats, GridWalk* w) {
  const Accel& accel = w->accel;
  CHECK_LE(sizeof(GridHeader) + sizeof(GridNode), accel.data.bytes());
  w->hit.triangle = kNoTriangle;
  if (!(ray.t_max > 0) || is_empty(accel.bounds) || !make_sheared_ray(ray, &w->ray)) return false;
  w->filter = filter, w->stats = stats;
  w->t_max = ray.t_max, w->from = ray.from, w->to = ray.to;
  w->clock = w->grid.header().clock.load(std::memory_order_relaxed);
  w->main = w->ray.kz, w->minor[0] = w->ray.kx, w->minor[1] = w->ray.ky;
  double d = double(ray.direction[w->main]);
  w->sign = d > 0 ? 1 : -1, w->speed = std::fabs(d);
  double farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    w->origin[axis] = double(ray.origin[axis]), w->slope[axis] = double(ray.direction[axis]) / w->speed;
    w->inverse_slope[axis] = std::fabs(w->slope[axis]) > 0x1p-60 ? 1 / w->slope[axis] : 0;
    farthest = std::max(farthest, std::fabs(w->origin[axis]));
  }
  double reach = reach_of(accel.bounds, w->origin);
  w->padding = reach * 0x1p-19 + (reach + farthest) * 0x1p-48 + 0x1p-100;
  w->limit = distance_at(*w, ray.t_max);
  std::fill_n(w->tested, kMailboxSize, kNoTriangle);
  return true;
}

void walk_to_closest(GridWalk* w) { walk_grid<false>(w, kRootPlace, -w->padding, w->limit + w->padding); }
bool walk_to_any(GridWalk* w) { return walk_grid<true>(w, kRootPlace, -w->padding, w->limit + w->padding); }

}  // namespace pocketray
