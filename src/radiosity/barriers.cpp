#include "radiosity/barriers.h"

#include "base/check.h"

namespace pocketray {
namespace {

constexpr float kContrast = 3;  // chosen: below, the loss on the bright side would be as large as what it saves

float brightness(const Vec3& v) { return v.x + v.y + v.z; }

}  // namespace

void keep_behind_barriers(const SceneRays& rays, const std::vector<NodePlace>& places, const std::vector<char>& known,
                          RadiositySolution* solution) {
  CHECK_EQ(places.size(), solution->nodes.size());
  std::vector<Vec3> kept;
  for (const RadiosityNode& node : solution->nodes) kept.push_back(node.value);
  for (const RadiosityGrid& grid : solution->grids) {
    const int columns = static_cast<int>(grid.columns), rows = static_cast<int>(grid.rows);
    auto compare = [&](int from, int to) {
      const std::size_t a = grid.node_begin + static_cast<std::size_t>(from),
                        b = grid.node_begin + static_cast<std::size_t>(to);
      if (!known[a] || !known[b]) return;
      const Vec3 &at_a = solution->nodes[a].value, &at_b = solution->nodes[b].value;
      const bool a_is_bright = brightness(at_a) > brightness(at_b);
      const Vec3 &bright = a_is_bright ? at_a : at_b, &dark = a_is_bright ? at_b : at_a;
      if (!(brightness(bright) > kContrast * brightness(dark))) return;
      CHECK(places[a].node == a && places[b].node == b);
      const Receiver& end = places[b].at;
      if (is_visible(rays, places[a].at, end.point + end.normal * end.lift)) return;
      Vec3& value = kept[a_is_bright ? a : b];
      value = min(value, dark);
    };
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const int at = row * columns + column;
        if (column + 1 < columns) compare(at, at + 1);
        if (row + 1 == rows) continue;
        compare(at, at + columns);
        if (column + 1 < columns) compare(at, at + columns + 1);
        if (column > 0) compare(at, at + columns - 1);
      }
  }
  for (std::size_t i = 0; i < kept.size(); ++i) solution->nodes[i].value = kept[i];
}

}  // namespace pocketray
