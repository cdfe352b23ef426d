#include "desktop/radiosity/grids.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "indirect/radiosity.h"

namespace pocketray {
namespace {

constexpr double kInset = 0.05;  // of a cell: nodes keep off borders
constexpr double kLift = 1e-3;   // of a cell
// Measured by `make rooms`: of the distance at which interpolation lets out of a gap what comes out, most of which is
// closer to it than a pixel.
constexpr double kOffGap = 1.8;
constexpr double kShort = 0.25;  // of a distance of nodes: a barrier that is shorter divides no grid
constexpr double kStrip = 1e-2;  // of a distance of nodes: no part is narrower
constexpr int kCutsMax = 64;     // of a side of a surface

// Part of a flat surface in a rectangle from an origin.
struct Area {
  Vec3d origin;
  double width, height;
  std::vector<Polygon> pieces;
};

struct Line {
  Vec3d origin, across;  // unit
};

// The nearest point of a convex polygon [Ericson 2005, sec. 5.1.5], by clamping edge by edge.
Vec3d nearest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d way = b - a;
  const double square = dot(way, way), t = square > 0 ? dot(p - a, way) / square : 0;
  return a + way * std::min(1.0, std::max(0.0, t));
}
Vec3d nearest_on_polygon(const Vec3d& p, const Polygon& polygon) {
  Vec3d n = {0, 0, 0};
  for (std::size_t i = 2; i < polygon.size(); ++i) n += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  bool inside = true;
  Vec3d best = polygon[0];
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    inside = inside && dot(cross(b - a, p - a), n) >= 0;
    const Vec3d q = nearest_on_segment(p, a, b);
    if (length(q - p) < length(best - p)) best = q;
  }
  return inside ? p : best;
}

// A point of the plane moved onto the area; from a border towards the middle of the piece it lies on.
Vec3d onto_area(const Area& area, const Vec3d& point) {
  Vec3d best = point;
  double least = 1e300;
  for (const Polygon& piece : area.pieces) {
    const Vec3d near = nearest_on_polygon(point, piece);
    const double distance = length(near - point);
    if (distance < least) least = distance, best = near;
    if (least == 0) break;
  }
  return best;
}

// The side of an area where dot(p − origin, axis) ≥ 0; without pieces if it is narrower than `least`.
Area side_of(const FlatSurface& flat, const Area& area, const Line& line, double sign, double least) {
  Area part = {area.origin, 0, 0, {}};
  const Vec3d axis = line.across * sign;
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300}, reach = 0;
  for (const Polygon& piece : area.pieces) {
    const Polygon rest = clip(piece, line.origin, axis, 0);
    if (rest.size() < 3 || !(polygon_area(rest) > 0)) continue;
    part.pieces.push_back(rest);
    for (const Vec3d& p : rest) {
      const double at[2] = {dot(p - area.origin, flat.s), dot(p - area.origin, flat.t)};
      for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
      reach = std::max(reach, dot(p - line.origin, axis));
    }
  }
  if (!(reach > least)) return {area.origin, 0, 0, {}};
  part.origin = area.origin + flat.s * low[0] + flat.t * low[1];
  part.width = high[0] - low[0], part.height = high[1] - low[1];
  return part;
}

// Length of the part of a barrier that lies in an area's rectangle, at least `margin` off the border along which it
// runs.
double length_in(const FlatSurface& flat, const Area& area, const Barrier& barrier, double margin) {
  const Vec3d way = barrier.b - barrier.a, axes[2] = {flat.s, flat.t};
  const double size[2] = {area.width, area.height};
  double begin = 0, end = 1;
  for (int k = 0; k < 2; ++k) {
    const double from = dot(barrier.a - area.origin, axes[k]), step = dot(way, axes[k]);
    const double low = margin, high = size[k] - margin;
    if (std::fabs(step) < 1e-9 * length(way)) {
      if (from < low || from > high) return 0;
      continue;
    }
    const double x = (low - from) / step, y = (high - from) / step;
    begin = std::max(begin, std::min(x, y)), end = std::min(end, std::max(x, y));
  }
  return end > begin ? (end - begin) * length(way) : 0;
}

struct GridPlacer {
  const FlatSurface& flat;
  const std::vector<Barrier>& barriers;
  double spacing;
  bool back;
  Places* places;
  RadiositySolution* solution;
  int cuts_left;

  // Returns whether a barrier crosses a line at a point of it, or ends within `reach` of that point.
  bool is_closed(const Line& line, const Vec3d& at, double reach) const {
    for (const Barrier& barrier : barriers) {
      const Vec3d way = barrier.b - barrier.a;
      if (std::fabs(dot(barrier.a - line.origin, line.across)) > kStrip * spacing ||
          std::fabs(dot(barrier.b - line.origin, line.across)) > kStrip * spacing)
        continue;
      const double size = length(way), along = dot(at - barrier.a, way) / size;
      if (along > -reach && along < size + reach) return true;
    }
    return false;
  }

  void add_seams(std::uint32_t node, const Vec3d& at, double cell, const std::vector<Line>& lines) {
    for (const Line& line : lines) {
      const double off = dot(at - line.origin, line.across);
      if (std::fabs(off) > 2 * kInset * cell) continue;
      const Vec3d foot = at - line.across * off;
      if (!is_closed(line, foot, kInset * cell))
        places->seams.push_back({node, kNone, foot - line.across * std::copysign(1e-6 * cell, off)});
    }
  }

  // Light that comes out of a gap of height h falls off as (1 − d/√(d² + h²))/2, h/2 in all. Interpolation over a
  // cell lets out as much if the node outside has h/cell of it. One inside keeps to where views from outside reach.
  Vec3d beside_gaps(Vec3d node, double cell) const {
    for (const Barrier& barrier : barriers) {
      const double q = 1 - 2 * barrier.gap / cell;
      if (!(barrier.gap > 0 && q > 0)) continue;
      const Vec3d way = barrier.b - barrier.a;
      const double along = dot(node - barrier.a, way) / dot(way, way), off = dot(node - barrier.a, barrier.inward);
      if (along < 0 || along > 1) continue;
      const double outside = kOffGap * barrier.gap * q / std::sqrt(1 - q * q), inside = 0.5 * barrier.gap;
      if (off < 0 && off > -outside) node += barrier.inward * -(outside + off);
      if (off > inside && off < 1.5 * kInset * cell) node += barrier.inward * (inside - off);
    }
    return node;
  }

  std::uint32_t place_grid(const Area& area, const std::vector<Line>& lines) {
    auto count_of = [&](double size) {
      return std::min<std::uint32_t>(kRadiositySideMax,
                                     1 + std::max(1u, static_cast<std::uint32_t>(size / spacing + 0.75)));
    };
    const std::uint32_t columns = count_of(area.width), rows = count_of(area.height);
    const double step_s = area.width / (columns - 1), step_t = area.height / (rows - 1),
                 cell = std::min(step_s, step_t);
    CHECK(columns >= 2 && rows >= 2);
    RadiosityGrid grid;
    grid.origin = to_float(area.origin);
    grid.along_s = to_float(flat.s / step_s), grid.along_t = to_float(flat.t / step_t);
    grid.columns = columns, grid.rows = rows;
    grid.node_begin = static_cast<std::uint32_t>(solution->nodes.size());
    const Vec3d normal = back ? -flat.normal : flat.normal;
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < columns; ++column) {
        auto inset = [](std::uint32_t i, std::uint32_t count) {
          return i == 0 ? kInset : i == count - 1 ? i - kInset : static_cast<double>(i);
        };
        const Vec3d wanted = beside_gaps(
            area.origin + flat.s * (inset(column, columns) * step_s) + flat.t * (inset(row, rows) * step_t), cell);
        Vec3d on = onto_area(area, wanted);
        if (on != wanted) {  // a little beyond the border, inside
          const Vec3d inward = on - wanted;
          on += inward * (kInset * cell / length(inward));
          on = onto_area(area, on);
        }
        const std::uint32_t node = static_cast<std::uint32_t>(solution->nodes.size());
        add_seams(node, on, std::max(step_s, step_t), lines);
        places->nodes.push_back({node, {on, normal, kLift * cell}, flat.material});
        solution->nodes.push_back({});
      }
    solution->grids.push_back(grid);
    return kRadiosityGridBit | static_cast<std::uint32_t>(solution->grids.size() - 1);
  }

  const Barrier* longest_in(const Area& area) const {
    const Barrier* longest = nullptr;
    double most = kShort * spacing;
    for (const Barrier& barrier : barriers) {
      const double size = length_in(flat, area, barrier, kStrip * spacing);
      if (size > most) most = size, longest = &barrier;
    }
    return longest;
  }

  // A reference to it.
  std::uint32_t divide(const Area& area, std::vector<Line> lines) {
    const Barrier* barrier = cuts_left > 0 ? longest_in(area) : nullptr;
    if (barrier == nullptr) return place_grid(area, lines);
    const Line line = {barrier->a, normalize(cross(flat.normal, barrier->b - barrier->a))};
    const Area below = side_of(flat, area, line, -1, kStrip * spacing),
               above = side_of(flat, area, line, 1, kStrip * spacing);
    if (below.pieces.empty() || above.pieces.empty()) return place_grid(area, lines);
    --cuts_left;
    lines.push_back(line);
    const std::size_t index = solution->cuts.size();
    CHECK_LT(index, std::size_t(kRadiositySplitBit - 1));
    solution->cuts.push_back({});
    const std::uint32_t first = divide(below, lines), second = divide(above, lines);
    solution->cuts[index] = {to_float(line.origin), to_float(line.across), {first, second}};
    return kRadiosityCutBits | static_cast<std::uint32_t>(index);
  }
};

}  // namespace

void place_grids(const Scene& scene, const FlatSurface& flat, const std::vector<Barrier>& barriers, double spacing,
                 bool back, Places* places, RadiositySolution* solution) {
  CHECK(places != nullptr && solution != nullptr);
  CHECK(spacing > 0);
  Area whole = {flat.origin, flat.width, flat.height, {}};
  for (std::uint32_t t : flat.triangles)
    whole.pieces.push_back({corner_of(scene, t, 0), corner_of(scene, t, 1), corner_of(scene, t, 2)});
  const std::size_t seams = places->seams.size();
  GridPlacer placer = {flat, barriers, spacing, back, places, solution, kCutsMax};
  const std::uint32_t place = placer.divide(whole, {});
  for (std::uint32_t t : flat.triangles) solution->triangles[back ? scene.triangles.count + t : t] = place;
  for (std::size_t i = seams; i < places->seams.size(); ++i) places->seams[i].place = place;
}

void join_seams(const std::vector<Seam>& seams, RadiositySolution* solution) {
  if (seams.empty()) return;
  Scene scene;
  solution->view(&scene);
  std::vector<Vec3> sum(solution->nodes.size(), Vec3{0, 0, 0});
  std::vector<float> count(solution->nodes.size(), 0);
  for (const Seam& seam : seams) {
    CHECK_LT(seam.node, solution->nodes.size());
    CHECK(seam.place != kNone);
    const Vec3 point = to_float(seam.beyond);
    sum[seam.node] += radiosity_of_grid(scene, grid_around(scene, seam.place, point), point, Reconstruction::bilinear);
    ++count[seam.node];
  }
  for (std::size_t i = 0; i < sum.size(); ++i)
    if (count[i] > 0) solution->nodes[i].value = (solution->nodes[i].value + sum[i]) / (1 + count[i]);
}

}  // namespace pocketray
