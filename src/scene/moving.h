// Tells which vertices and triangles can move.
#pragma once
#include <algorithm>

#include "scene/scene.h"

namespace pocketray {

// Returns whether a vertex lies in one of the runs, which are in ascending order.
inline bool moves(Array<const MovingMesh> runs, std::uint32_t vertex) {
  const MovingMesh* next = std::upper_bound(runs.begin(), runs.end(), vertex,
                                            [](std::uint32_t v, const MovingMesh& m) { return v < m.vertex_begin; });
  return next != runs.begin() && vertex - next[-1].vertex_begin < next[-1].vertex_count;
}

inline bool moves(Array<const MovingMesh> runs, const Triangle& t) {
  return moves(runs, t.vertex(0)) || moves(runs, t.vertex(1)) || moves(runs, t.vertex(2));
}

}  // namespace pocketray
