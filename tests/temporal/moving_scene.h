// Small scenes in which some vertices move.
#pragma once
#include "support/generated_scene.h"

namespace pocketray {

inline std::uint32_t vertex_count(const GeneratedScene& s) { return static_cast<std::uint32_t>(s.positions.size()); }

// Lets the vertices from `first` on move: tests change their positions at rest.
inline void let_move(GeneratedScene* s, std::uint32_t first) {
  s->nodes.resize(1);
  s->animations = {{0, 0, 1}};
  MovingMesh mesh = {};
  mesh.vertex_begin = first, mesh.vertex_count = vertex_count(*s) - first;
  mesh.skin = kNone, mesh.instance = Transform();
  s->moving_meshes = {mesh};
  s->rest_positions.assign(s->positions.begin() + first, s->positions.end());
  s->rest_normals.assign(s->normals.begin() + first, s->normals.end());
}

}  // namespace pocketray
