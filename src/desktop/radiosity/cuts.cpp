#include "desktop/radiosity/cuts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace pocketray {
namespace {

constexpr double kReach = 0.25;     // of a patch's side
constexpr double kPartMin = 1e-4;   // of a cell's area
constexpr double kShared = 1e-3;    // of a part's size: a shorter way through it does not count
constexpr std::size_t kParts = 16;  // of one cell
constexpr double kBend = 1 - 1e-5;  // cosine between normals, as in surfaces.cpp
constexpr double kLongEdge = 0.5;   // of a patch's side
constexpr std::size_t kEdges = 1 << 16;

double area_of(const std::vector<Piece>& pieces) {
  double area = 0;
  for (const Piece& piece : pieces) area += polygon_area(piece.polygon);
  return area;
}

std::vector<Piece> side_of(const std::vector<Piece>& pieces, const Vec3d& origin, const Vec3d& axis) {
  std::vector<Piece> result;
  for (const Piece& piece : pieces) {
    Polygon part = clip(piece.polygon, origin, axis, 0);
    if (part.size() >= 3) result.push_back({std::move(part), piece.triangle});
  }
  return result;
}

// Length of the part of an edge within the rectangle around some pieces, relative to that.
double share_within(const FlatSurface& flat, const CutEdge& edge, const std::vector<Piece>& pieces) {
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300}, begin = 0, end = 1;
  const Vec3d axes[2] = {flat.s, flat.t};
  for (const Piece& piece : pieces)
    for (const Vec3d& p : piece.polygon)
      for (int k = 0; k < 2; ++k)
        low[k] = std::min(low[k], dot(p - edge.a, axes[k])), high[k] = std::max(high[k], dot(p - edge.a, axes[k]));
  const Vec3d way = edge.b - edge.a;
  for (int k = 0; k < 2; ++k) {
    const double step = dot(way, axes[k]);
    if (step == 0) {
      if (low[k] > 0 || high[k] < 0) return 0;
      continue;
    }
    const double x = low[k] / step, y = high[k] / step;
    begin = std::max(begin, std::min(x, y)), end = std::min(end, std::max(x, y));
  }
  if (!(begin < end)) return 0;
  return (end - begin) * length(way) / std::max(high[0] - low[0], high[1] - low[1]);
}

}  // namespace

Polygon clip(const Polygon& polygon, const Vec3d& origin, const Vec3d& axis, double limit) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double x = dot(a - origin, axis) - limit, y = dot(b - origin, axis) - limit;
    if (x >= 0) result.push_back(a);
    if ((x > 0 && y < 0) || (x < 0 && y > 0)) result.push_back(a + (b - a) * (x / (x - y)));
  }
  return result;
}

std::vector<CutEdge> find_cut_edges(const Scene& scene, const Surfaces& surfaces) {
  using Point = std::tuple<float, float, float>;
  struct Neighbours {
    std::uint32_t first;
    int count;
    bool bends, shines;
  };
  std::map<std::pair<Point, Point>, Neighbours> found;
  auto point = [&](std::uint32_t v) {
    const Vec3& p = scene.positions[v];
    return Point(p.x, p.y, p.z);
  };
  const double least = kLongEdge * surfaces.patch_side;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (!(surfaces.area[i] > 0)) continue;
    const Triangle& t = scene.triangles[i];
    const bool shines = !is_zero(scene.materials[t.material()].emission);
    for (std::uint32_t c = 0; c < 3; ++c) {
      const std::uint32_t from = t.vertex(c), to = t.vertex((c + 1) % 3);
      if (!shines && length(to_double(scene.positions[to]) - to_double(scene.positions[from])) < least) continue;
      const Point a = point(from), b = point(to);
      const auto entry = found.emplace(std::minmax(a, b), Neighbours{i, 0, false, false});
      Neighbours& n = entry.first->second;
      ++n.count, n.shines |= shines;
      n.bends |= !entry.second && dot(surfaces.normal[n.first], surfaces.normal[i]) < kBend;
    }
  }
  std::vector<CutEdge> edges;
  auto vector = [](const Point& p) {
    return Vec3d{static_cast<double>(std::get<0>(p)), static_cast<double>(std::get<1>(p)),
                 static_cast<double>(std::get<2>(p))};
  };
  for (const auto& entry : found)
    if ((entry.second.count == 1 || entry.second.bends) && edges.size() < kEdges)
      edges.push_back(
          {vector(entry.first.first), vector(entry.first.second), entry.second.count == 1, entry.second.first, 0});
  return edges;
}

std::vector<CutEdge> edges_close_to(const FlatSurface& flat, const std::vector<CutEdge>& edges, double patch_side) {
  const double reach = kReach * patch_side;
  std::vector<CutEdge> result;
  for (const CutEdge& edge : edges) {
    double a = dot(edge.a - flat.origin, flat.normal), b = dot(edge.b - flat.origin, flat.normal);
    if (std::min(a, b) > reach || std::max(a, b) < -reach) continue;
    auto at_height = [&](double own, const Vec3d& from, double other, const Vec3d& to) {
      const double limit = own > reach ? reach : own < -reach ? -reach : own;
      const Vec3d p = own == limit ? from : from + (to - from) * ((own - limit) / (own - other));
      return p - flat.normal * dot(p - flat.origin, flat.normal);
    };
    const CutEdge close = {at_height(a, edge.a, b, edge.b), at_height(b, edge.b, a, edge.a), edge.is_end, edge.triangle,
                           std::min(reach, std::max(std::fabs(a), std::fabs(b)))};
    if (length(close.b - close.a) > kShared * patch_side) result.push_back(close);
  }
  return result;
}

std::vector<std::vector<Piece>> cut_cell(const FlatSurface& flat, const std::vector<CutEdge>& edges,
                                         const std::vector<Piece>& cell) {
  std::vector<std::vector<Piece>> parts = {cell};
  const double least = kPartMin * area_of(cell);
  for (const CutEdge& edge : edges) {
    if (share_within(flat, edge, cell) < kShared) continue;
    const Vec3d across = normalize(cross(flat.normal, edge.b - edge.a));
    for (std::size_t i = 0, count = parts.size(); i < count && parts.size() < kParts; ++i) {
      if (share_within(flat, edge, parts[i]) < kShared) continue;
      std::vector<Piece> left = side_of(parts[i], edge.a, across), right = side_of(parts[i], edge.a, -across);
      if (area_of(left) < least || area_of(right) < least) continue;
      parts[i] = std::move(left), parts.push_back(std::move(right));
    }
  }
  return parts;
}

}  // namespace pocketray
