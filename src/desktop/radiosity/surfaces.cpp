#include "desktop/radiosity/surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kFlat = 1 - 1e-5;   // cosine between normals of one plane: a quarter of a degree
constexpr double kOffPlane = 1e-3;   // of the distance, relative to the part's size
constexpr double kPatchesMin = 1.5;  // along the longer side

// A flat triangle shaded as such: its vertex normals, if any, are its own.
bool is_shaded_flat(const Scene& scene, std::uint32_t triangle, const Vec3d& normal) {
  if (scene.normals.empty()) return true;
  for (std::uint32_t v : scene.triangles[triangle].vertices()) {
    const Vec3d n = to_double(scene.normals[v]);
    if (!is_zero(n) && dot(normalize(n), normal) < kFlat) return false;
  }
  return true;
}

// Joins neighbours across shared edges; vertices are the same if their positions are.
void join_neighbours(const Scene& scene, const Surfaces& surfaces, const std::vector<char>& flat, Forest* forest) {
  using Point = std::tuple<float, float, float>;
  auto point = [&](std::uint32_t v) {
    const Vec3& p = scene.positions[v];
    return Point(p.x, p.y, p.z);
  };
  std::map<std::pair<Point, Point>, std::uint32_t> edges;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (!flat[i]) continue;
    const Triangle& t = scene.triangles[i];
    for (std::uint32_t c = 0; c < 3; ++c) {
      Point a = point(t.vertex(c)), b = point(t.vertex((c + 1) % 3));
      auto found = edges.emplace(std::minmax(a, b), i);
      if (found.second) continue;
      const std::uint32_t other = found.first->second;
      if (scene.triangles[other].material() == t.material() &&
          dot(surfaces.normal[other], surfaces.normal[forest->find(i)]) > kFlat &&
          dot(surfaces.normal[other], surfaces.normal[forest->find(other)]) > kFlat)
        forest->join(other, i);
      found.first->second = i;
    }
  }
}

void enclose(const Scene& scene, FlatSurface* flat) {
  std::vector<Vec3d> points;
  for (std::uint32_t t : flat->triangles)
    for (int c = 0; c < 3; ++c) points.push_back(corner_of(scene, t, c));
  double least = 0;
  const std::size_t step = std::max<std::size_t>(1, flat->triangles.size() / 64);
  for (std::size_t k = 0; k < flat->triangles.size(); k += step)  // the rectangle of least area along an edge
    for (int c = 0; c < 3; ++c) {
      const Vec3d along =
          points[3 * k + static_cast<std::size_t>((c + 1) % 3)] - points[3 * k + static_cast<std::size_t>(c)];
      if (!(length(along) > 0)) continue;
      const Vec3d s = normalize(along), t = cross(flat->normal, s);
      double low_s = 0, high_s = 0, low_t = 0, high_t = 0;
      for (const Vec3d& p : points) {
        const double x = dot(p - points[0], s), y = dot(p - points[0], t);
        low_s = std::min(low_s, x), high_s = std::max(high_s, x);
        low_t = std::min(low_t, y), high_t = std::max(high_t, y);
      }
      const double area = (high_s - low_s) * (high_t - low_t);
      if (least > 0 && !(area < least * (1 - 1e-9))) continue;
      least = area;
      flat->s = s, flat->t = t, flat->width = high_s - low_s, flat->height = high_t - low_t;
      flat->origin = points[0] + s * low_s + t * low_t;
    }
}

// Returns whether two parts lie in one plane and their rectangles touch.
bool is_one(const FlatSurface& a, const FlatSurface& b) {
  if (a.material != b.material || dot(a.normal, b.normal) < kFlat) return false;
  const double size = std::max({a.width, a.height, b.width, b.height});
  double low_s = 1e300, high_s = -1e300, low_t = 1e300, high_t = -1e300;
  for (int i = 0; i < 4; ++i) {
    const Vec3d corner = b.origin + b.s * (i & 1 ? b.width : 0.0) + b.t * (i & 2 ? b.height : 0.0) - a.origin;
    if (std::fabs(dot(corner, a.normal)) > kOffPlane * size) return false;
    low_s = std::min(low_s, dot(corner, a.s)), high_s = std::max(high_s, dot(corner, a.s));
    low_t = std::min(low_t, dot(corner, a.t)), high_t = std::max(high_t, dot(corner, a.t));
  }
  const double reach = kOffPlane * size;
  return low_s <= a.width + reach && high_s >= -reach && low_t <= a.height + reach && high_t >= -reach;
}

}  // namespace

Surfaces find_surfaces(const Scene& scene, std::uint32_t patch_count) {
  CHECK_GT(patch_count, 0u);
  Surfaces result;
  const std::uint32_t count = scene.triangles.count;
  std::vector<char> flat(count);
  result.normal.resize(count), result.area.resize(count), result.flat_of.assign(count, kNone);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d a = corner_of(scene, i, 0);
    const Vec3d n = cross(corner_of(scene, i, 1) - a, corner_of(scene, i, 2) - a);
    result.area[i] = 0.5 * length(n), result.normal[i] = normalize(n);
    result.total_area += result.area[i];
    flat[i] = result.area[i] > 0 && is_shaded_flat(scene, i, result.normal[i]);
  }
  result.patch_side = std::sqrt(result.total_area / patch_count);
  Forest forest(count);
  join_neighbours(scene, result, flat, &forest);
  std::map<std::uint32_t, FlatSurface> parts;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!flat[i]) continue;
    FlatSurface& part = parts[forest.find(i)];
    part.triangles.push_back(i), part.material = scene.triangles[i].material();
  }
  std::vector<FlatSurface> large;
  for (auto& entry : parts) {
    FlatSurface& part = entry.second;
    part.normal = result.normal[part.triangles[0]];
    enclose(scene, &part);
    if (std::max(part.width, part.height) >= kPatchesMin * result.patch_side) large.push_back(part);
  }
  for (std::size_t i = 0; i < large.size(); ++i)
    for (std::size_t k = i + 1; k < large.size();) {
      if (!is_one(large[i], large[k])) {
        ++k;
        continue;
      }
      large[i].triangles.insert(large[i].triangles.end(), large[k].triangles.begin(), large[k].triangles.end());
      enclose(scene, &large[i]);
      large.erase(large.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;  // it may reach others now
    }
  for (FlatSurface& part : large) {
    part.area = 0;
    for (std::uint32_t t : part.triangles)
      result.flat_of[t] = static_cast<std::uint32_t>(result.flat.size()), part.area += result.area[t];
    result.flat.push_back(part);
  }
  for (std::uint32_t i = 0; i < count; ++i)
    if (result.flat_of[i] == kNone && result.area[i] > 0) result.others.push_back(i);
  return result;
}

}  // namespace pocketray
