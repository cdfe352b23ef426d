#include "desktop/radiosity/bodies.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "desktop/radiosity/surfaces.h"

namespace pocketray {
namespace {

constexpr double kOpen = 0.1;  // of the edges' length; chosen: a scan has holes, a box without a lid is open

using Point = std::tuple<float, float, float>;
struct Side {
  std::uint32_t triangle;
  bool is_shared;
  double length;
};

}  // namespace

std::vector<char> find_bodies(const Scene& scene) {
  Forest forest(scene.triangles.count);
  std::map<std::pair<Point, Point>, Side> sides;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i)
    for (std::uint32_t c = 0; c < 3; ++c) {
      const Vec3 &a = scene.positions[scene.triangles[i].vertex(c)],
                 &b = scene.positions[scene.triangles[i].vertex((c + 1) % 3)];
      const Side side = {i, false, length(to_double(b) - to_double(a))};
      const auto found = sides.emplace(std::minmax(Point(a.x, a.y, a.z), Point(b.x, b.y, b.z)), side);
      if (found.second) continue;
      found.first->second.is_shared = true;
      forest.join(found.first->second.triangle, i);
    }
  std::vector<double> all(scene.triangles.count, 0), open(scene.triangles.count, 0);
  for (const auto& entry : sides) {
    const Side& side = entry.second;
    const std::uint32_t part = forest.find(side.triangle);
    all[part] += side.length;
    if (!side.is_shared) open[part] += side.length;
  }
  std::vector<char> bodies(scene.triangles.count);
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    const std::uint32_t part = forest.find(i);
    bodies[i] = open[part] < kOpen * all[part];
  }
  return bodies;
}

}  // namespace pocketray
