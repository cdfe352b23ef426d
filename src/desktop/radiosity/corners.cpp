#include "desktop/radiosity/corners.h"

#include <cmath>
#include <map>
#include <tuple>

#include "base/check.h"

namespace pocketray {
namespace {

constexpr double kInset = 0.02;  // of the way to a part's centre
constexpr double kLift = 1e-3;   // of that way

struct Corner {
  Vec3d position, normal;
  std::uint32_t vertex;  // whose value it takes, or kNone
};

Corner middle_of(const Corner& a, const Corner& b) {
  return {(a.position + b.position) * 0.5, normalize(a.normal + b.normal), kNone};
}

struct CornerKey {
  Vec3d position;
  int normal[3];
  bool operator<(const CornerKey& o) const {
    return std::tie(position.x, position.y, position.z, normal[0], normal[1], normal[2]) <
           std::tie(o.position.x, o.position.y, o.position.z, o.normal[0], o.normal[1], o.normal[2]);
  }
};

struct CornerWriter {
  double edge_max;
  bool back;
  std::uint32_t material;
  Places* places;
  RadiositySolution* solution;
  std::map<CornerKey, std::uint32_t> shared;
  std::vector<char> at_vertex;  // it has its value

  std::uint32_t value_at(const Corner& corner, const Vec3d& centre) {
    const Vec3d way = centre - corner.position;
    const Receiver at = {corner.position + way * kInset, back ? -corner.normal : corner.normal, kLift * length(way)};
    if (corner.vertex != kNone) {
      if (!at_vertex[corner.vertex]) places->values.push_back({corner.vertex, at, material});
      at_vertex[corner.vertex] = 1;
      return corner.vertex;
    }
    CornerKey key = {corner.position, {}};
    for (int axis = 0; axis < 3; ++axis)
      key.normal[axis] = static_cast<int>(std::floor(corner.normal[axis] * 500 + 0.5));
    auto found = shared.emplace(key, static_cast<std::uint32_t>(solution->values.size()));
    if (found.second) {
      places->values.push_back({found.first->second, at, material});
      solution->values.push_back({0, 0, 0});
    }
    return found.first->second;
  }

  // The edge from one corner to the next that is to be halved, or -1.
  int edge_to_halve(const Corner (&c)[3]) const {
    int longest = 0;
    double squares[3];
    for (int k = 0; k < 3; ++k) {
      const Vec3d along = c[(k + 1) % 3].position - c[k].position;
      squares[k] = dot(along, along);
      if (squares[k] > squares[longest]) longest = k;
    }
    return squares[longest] > edge_max * edge_max ? longest : -1;
  }

  // A reference to it, as a part.
  std::uint32_t divide(const Corner (&c)[3], std::uint32_t level) {
    const int edge = edge_to_halve(c);
    const bool full = level > kRadiosityLevelMax || solution->corners.size() > kRadiosityPartMax / 2;
    if (edge < 0 || full) {
      const Vec3d centre = (c[0].position + c[1].position + c[2].position) / 3.0;
      RadiosityCorners corners;
      for (int k = 0; k < 3; ++k) corners.value[k] = value_at(c[k], centre);
      solution->corners.push_back(corners);
      return static_cast<std::uint32_t>(solution->corners.size() - 1);
    }
    const Corner &a = c[edge], &b = c[(edge + 1) % 3], &apex = c[(edge + 2) % 3], m = middle_of(a, b);
    const std::uint32_t index = static_cast<std::uint32_t>(solution->splits.size());
    solution->splits.push_back({});
    const std::uint32_t first = divide({a, m, apex}, level + 1), second = divide({m, b, apex}, level + 1);
    solution->splits[index] = {{first | level << kRadiosityLevelShift, second}};
    return kRadiositySplitBit | static_cast<std::uint32_t>(edge) << kRadiosityTurnShift | index;
  }
};

}  // namespace

void place_corners(const Scene& scene, const Surfaces& surfaces, double edge_max, bool back,
                   const std::vector<char>& sees, Places* places, RadiositySolution* solution) {
  CHECK(edge_max > 0);
  CHECK(places != nullptr && solution != nullptr);
  CornerWriter writer = {edge_max, back, kNone, places, solution, {}, std::vector<char>(scene.positions.count, 0)};
  if (!back && scene.normals.count && !surfaces.others.empty())
    solution->values.resize(scene.positions.count, Vec3{0, 0, 0});  // before those that corners share
  for (std::uint32_t t : surfaces.others) {
    if (!sees[t] || !reflects(scene.materials[scene.triangles[t].material()])) continue;
    writer.material = scene.triangles[t].material();
    Corner corners[3];
    bool all_smooth = !back;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = scene.triangles[t].vertex(static_cast<std::uint32_t>(c));
      const Vec3d n = scene.normals.count ? to_double(scene.normals[v]) : Vec3d{0, 0, 0};
      const bool smooth = !is_zero(n) && dot(n, surfaces.normal[t]) > 0;
      corners[c] = {corner_of(scene, t, c), smooth ? normalize(n) : surfaces.normal[t], v};
      all_smooth &= smooth;
    }
    if (!all_smooth)
      for (Corner& corner : corners) corner.vertex = kNone;
    std::uint32_t* place = &solution->triangles[back ? scene.triangles.count + t : t];
    if (all_smooth && writer.edge_to_halve(corners) < 0) {
      const Vec3d centre = (corners[0].position + corners[1].position + corners[2].position) / 3.0;
      for (const Corner& corner : corners) writer.value_at(corner, centre);
      *place = kRadiosityAtVertices;
    } else {
      *place = writer.divide(corners, 0);
    }
  }
}

void fill_covered_values(const Scene& scene, std::vector<char>* known, RadiositySolution* solution) {
  CHECK_EQ(known->size(), solution->values.size());
  std::vector<RadiosityCorners> parts = solution->corners;
  for (std::uint32_t i = 0; i < solution->triangles.size(); ++i)
    if (solution->triangles[i] == kRadiosityAtVertices) {
      const Triangle& t = scene.triangles[i % scene.triangles.count];
      parts.push_back({{t.vertex(0), t.vertex(1), t.vertex(2)}});
    }
  for (bool changed = true; changed;) {
    changed = false;
    std::map<std::uint32_t, std::pair<Vec3, float>> sums;
    for (const RadiosityCorners& part : parts)
      for (std::uint32_t to : part.value)
        for (std::uint32_t from : part.value) {
          if ((*known)[to] || !(*known)[from]) continue;
          auto& sum = sums.emplace(to, std::make_pair(Vec3{0, 0, 0}, 0.0f)).first->second;
          sum.first += solution->values[from], sum.second += 1;
        }
    for (const auto& entry : sums) {
      solution->values[entry.first] = entry.second.first / entry.second.second;
      (*known)[entry.first] = changed = true;
    }
  }
}

}  // namespace pocketray
