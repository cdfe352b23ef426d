#include "desktop/import/polygon.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "desktop/import/broken_faces.h"
#include "desktop/import/planar_sweep.h"

namespace pocketray {
namespace {

// Twice the area vector [Newell], about the first corner.
Vec3d area_vector(const std::vector<Vec3>& p) {
  Vec3d sum = {0, 0, 0};
  const Vec3d origin = to_double(p[0]);
  for (std::size_t i = 1; i + 1 < p.size(); ++i) sum += cross(to_double(p[i]) - origin, to_double(p[i + 1]) - origin);
  return sum;
}

// Normal of three corners far apart; zero if all lie on a line.
Vec3d spanned_normal(const std::vector<Vec3>& p) {
  const Vec3d origin = to_double(p[0]);
  Vec3d far = {0, 0, 0}, normal = {0, 0, 0};
  for (const Vec3& q : p) {
    const Vec3d d = to_double(q) - origin;
    if (dot(d, d) > dot(far, far)) far = d;
  }
  for (const Vec3& q : p) {
    const Vec3d n = cross(far, to_double(q) - origin);
    if (dot(n, n) > dot(normal, normal)) normal = n;
  }
  return normal;
}

// A polygon that crosses itself may have a vanishing area vector.
Vec3d polygon_normal(const std::vector<Vec3>& p) {
  constexpr double kAreaShareMin = 1e-3;  // chosen: a smaller vector has no reliable direction
  const Vec3d sum = area_vector(p), spanned = spanned_normal(p);
  if (dot(sum, sum) >= kAreaShareMin * kAreaShareMin * dot(spanned, spanned)) return sum;
  return dot(sum, spanned) < 0 ? -spanned : spanned;
}

// Drops the coordinate along which the normal is longest, so that the others stay exact.
std::vector<Vec2> project(const std::vector<Vec3>& positions, const Vec3d& normal) {
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::fabs(normal[i]) > std::fabs(normal[axis])) axis = i;
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<Vec2> result;
  result.reserve(positions.size());
  for (const Vec3& p : positions) result.push_back({p[u], p[v]});
  return result;
}

// Returns whether the first corner sees all others in order, within half a turn.
bool is_fan(const std::vector<Vec2>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i)
    if (orientation(p[0], p[i], p[i + 1]) <= 0 || orientation(p[0], p[1], p[i + 1]) <= 0) return false;
  return true;
}

// Divides a quadrilateral along its shorter diagonal, if both are inside.
bool append_quadrilateral(const std::vector<Vec3>& p, const std::vector<Vec2>& loop,
                          std::vector<std::uint32_t>* corners) {
  if (p.size() != 4 || !is_fan(loop) || !is_fan({loop[1], loop[2], loop[3], loop[0]})) return false;
  const Vec3d first = to_double(p[2]) - to_double(p[0]), second = to_double(p[3]) - to_double(p[1]);
  if (dot(first, first) < dot(second, second))
    corners->insert(corners->end(), {0, 1, 2, 0, 2, 3});
  else
    corners->insert(corners->end(), {0, 1, 3, 1, 2, 3});
  return true;
}

double direction(const Vec2& from, double u, double v) {
  return std::atan2(v - static_cast<double>(from.y), u - static_cast<double>(from.x));
}
double turn(double from, double to) {
  const double angle = std::fmod(to - from, 2 * kPi);
  return angle < 0 ? angle + 2 * kPi : angle;
}

// Finds the corners of the loop at a point. If there are several, as at keyholes, each triangle gets the corner whose
// inside contains it.
class CornersAtPoints {
 public:
  CornersAtPoints(const std::vector<Vec2>& loop, const PlanarSweep& sweep)
      : loop_(loop),
        sweep_(sweep),
        steps_left_(64 * loop.size() + 1000),
        first_(sweep.points().size(), kNone),
        next_(loop.size(), kNone) {
    for (std::size_t i = loop.size(); i-- > 0;) {
      std::uint32_t& first = first_[sweep.points_of_corners()[i]];
      next_[i] = first;
      first = static_cast<std::uint32_t>(i);
    }
    for (std::size_t i = 0; i < sweep.crossings().size(); ++i) {
      std::uint32_t& first = first_[sweep.crossings()[i].point];
      if (first == kNone) first = static_cast<std::uint32_t>(loop.size() + i);
    }
  }

  // Returns corner `k` of the triangle of points.
  std::uint32_t find(const std::uint32_t* triangle, int k) const {
    const std::uint32_t first = first_[triangle[k]];
    CHECK(first != kNone);
    if (first >= loop_.size() || next_[first] == kNone) return first;
    const Vec2 &a = sweep_.points()[triangle[(k + 1) % 3]], &b = sweep_.points()[triangle[(k + 2) % 3]],
               &here = sweep_.points()[triangle[k]];
    const double from = direction(here, static_cast<double>(a.x), static_cast<double>(a.y));
    const double to = direction(here, static_cast<double>(b.x), static_cast<double>(b.y));
    const double middle = from + turn(from, to) / 2;
    for (std::uint32_t corner = first; corner != kNone && steps_left_ > 0; corner = next_[corner])
      if (holds(corner, middle)) return corner;
    return first;
  }

 private:
  // Returns whether the direction lies between the edges at the corner, on their left.
  bool holds(std::uint32_t corner, double middle) const {
    const Vec2& here = loop_[corner];
    double ends[2];
    for (std::size_t side : {0, 1}) {
      const std::size_t step = side == 0 ? 1 : loop_.size() - 1;
      std::size_t other = corner;
      do other = (other + step) % loop_.size();
      while (steps_left_ > 0 && --steps_left_ > 0 && other != corner &&
             sweep_.points_of_corners()[other] == sweep_.points_of_corners()[corner]);
      ends[side] = direction(here, static_cast<double>(loop_[other].x), static_cast<double>(loop_[other].y));
    }
    return turn(ends[0], middle) < turn(ends[0], ends[1]);
  }

  const std::vector<Vec2>& loop_;
  const PlanarSweep& sweep_;
  mutable std::size_t steps_left_;           // when used up, the first corner at a point is taken
  std::vector<std::uint32_t> first_, next_;  // by point; by corner
};

// Position of the point along the edge, from 0 to 1.
float along_edge(const std::vector<Vec2>& loop, std::uint32_t corner, const Vec2& point) {
  const Vec2 &a = loop[corner], &b = loop[(corner + 1) % loop.size()];
  const double du = static_cast<double>(b.x) - static_cast<double>(a.x),
               dv = static_cast<double>(b.y) - static_cast<double>(a.y);
  const double along = std::fabs(du) > std::fabs(dv) ? (static_cast<double>(point.x) - static_cast<double>(a.x)) / du
                                                     : (static_cast<double>(point.y) - static_cast<double>(a.y)) / dv;
  return static_cast<float>(std::min(std::max(along, 0.0), 1.0));
}

template <class T>
T mean(const T& a, const T& b, float t) {
  return a * (1 - t) + b * t;
}
Vec2 mean(const Vec2& a, const Vec2& b, float t) { return {a.x * (1 - t) + b.x * t, a.y * (1 - t) + b.y * t}; }
std::uint16_t mean(std::uint16_t a, std::uint16_t b, float t) {
  return static_cast<std::uint16_t>(static_cast<float>(a) * (1 - t) + static_cast<float>(b) * t + 0.5f);
}
Rgba16 mean(const Rgba16& a, const Rgba16& b, float t) {
  return {mean(a.r, b.r, t), mean(a.g, b.g, t), mean(a.b, b.b, t), mean(a.a, b.a, t)};
}

// Mean of both edges at the crossing.
template <class T>
void append_crossing(const std::vector<std::uint32_t>& vertices, const PolygonCrossing& crossing,
                     std::vector<T>* values) {
  if (values->empty()) return;
  T on[2];
  for (std::size_t i : {0, 1}) {
    const std::uint32_t a = vertices[crossing.edges[i]], b = vertices[(crossing.edges[i] + 1) % vertices.size()];
    on[i] = mean((*values)[a], (*values)[b], crossing.along[i]);
  }
  values->push_back(mean(on[0], on[1], 0.5f));
}

}  // namespace

bool triangulate_polygon(const std::vector<Vec3>& positions, PolygonTriangles* result) {
  result->corners.clear(), result->crossings.clear();
  if (positions.size() < 3) return true;
  const std::uint32_t count = static_cast<std::uint32_t>(positions.size());
  const std::vector<Vec2> loop = project(positions, polygon_normal(positions));
  if (append_quadrilateral(positions, loop, &result->corners)) return true;
  if (is_fan(loop)) {
    for (std::uint32_t i = 2; i < count; ++i) result->corners.insert(result->corners.end(), {0u, i - 1, i});
    return true;
  }
  constexpr std::size_t kCrossingsPerCornerMax = 64;  // chosen: bounds time and memory by the file's size
  PlanarSweep sweep;
  if (!sweep.triangulate(loop, kCrossingsPerCornerMax * loop.size())) return false;
  const CornersAtPoints corners(loop, sweep);
  const std::vector<std::uint32_t>& triangles = sweep.triangles();
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    for (int k = 0; k < 3; ++k) result->corners.push_back(corners.find(&triangles[t], k));
  // A corner that repeats the next has a triangle without area, so that a polygon of n corners has n − 2.
  for (std::uint32_t i = 0; i < count && !triangles.empty(); ++i)
    if (sweep.points_of_corners()[i] == sweep.points_of_corners()[(i + 1) % count])
      result->corners.insert(result->corners.end(), {i, (i + 1) % count, (i + 2) % count});
  for (const PlanarSweep::Crossing& crossing : sweep.crossings()) {
    PolygonCrossing made = {{crossing.edges[0], crossing.edges[1]}, {0, 0}};
    for (int i = 0; i < 2; ++i) made.along[i] = along_edge(loop, made.edges[i], sweep.points()[crossing.point]);
    result->crossings.push_back(made);
  }
  return true;
}

void append_polygon(const std::vector<std::uint32_t>& vertices, MeshData* mesh, SceneBuilder* builder) {
  for (std::uint32_t v : vertices)
    if (!is_coordinate(mesh->positions[v])) {
      require_finite(mesh->positions[v], mesh->name, *builder);
      builder->broken_face_count += vertices.size() >= 3;
      return;
    }
  if (vertices.size() <= 3) {
    if (vertices.size() == 3) mesh->indices.insert(mesh->indices.end(), vertices.begin(), vertices.end());
    return;
  }
  std::vector<Vec3> positions;
  positions.reserve(vertices.size());
  for (std::uint32_t v : vertices) positions.push_back(mesh->positions[v]);
  PolygonTriangles triangles;
  if (!triangulate_polygon(positions, &triangles))
    return note_remark(builder, "polygons that cross themselves too often are left out; triangulate them");
  const std::size_t made = mesh->positions.size();
  require_bytes(*builder, made + triangles.crossings.size(), 64, "the geometry");
  for (const PolygonCrossing& crossing : triangles.crossings) {
    append_crossing(vertices, crossing, &mesh->positions);
    append_crossing(vertices, crossing, &mesh->normals);
    append_crossing(vertices, crossing, &mesh->uvs);
    append_crossing(vertices, crossing, &mesh->colors);
    if (!mesh->normals.empty()) mesh->normals.back() = normalize(mesh->normals.back());
  }
  require_bytes(*builder, mesh->indices.size() + triangles.corners.size(), 4, "the faces");
  for (std::uint32_t corner : triangles.corners)
    mesh->indices.push_back(corner < vertices.size() ? vertices[corner]
                                                     : static_cast<std::uint32_t>(made + corner - vertices.size()));
}

}  // namespace pocketray
