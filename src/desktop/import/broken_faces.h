// Faces with vertices that are not finite or beyond kCoordinateMax (HARDCASES row 8): left out and counted, or refused
// with `strict`.
#pragma once
#include <vector>

#include "desktop/import/scene_builder.h"

namespace pocketray {

// True if a vertex may be part of a triangle.
bool is_coordinate(const Vec3& p);
// With options.strict, throws unless the vertex may be part of a triangle, naming the mesh.
void require_finite(const Vec3& p, const std::string& mesh_name, const SceneBuilder& builder);

// Removes the faces with a vertex that is not finite, or that a morph target moves by a non-finite vector.
void leave_out_broken_faces(MeshData* mesh, SceneBuilder* builder);
// Returns the mesh or, made in `kept`, the mesh without faces whose vertices are out of range once `placed`.
const MeshData& without_broken_faces(const MeshData& mesh, const std::vector<Vec3>& placed, SceneBuilder* builder,
                                     MeshData* kept);

}  // namespace pocketray
