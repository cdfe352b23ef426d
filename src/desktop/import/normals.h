// Normals for meshes without any.
#pragma once
#include <functional>

#include "desktop/import/scene_builder.h"

namespace pocketray {

// Edges sharper than this stay sharp: those of a box and of an eight-sided cylinder. Chosen; between 20° and 60° it
// makes no difference that is seen (tests/accuracy/FIGURES.md).
constexpr float kCreaseDegrees = 40;

// Gives every corner the mean normal of the triangles around its position whose planes differ by less than
// `crease_degrees` from the corner's own, weighted by angle [Thürmer & Wüthrich 1998]. Corners at equal positions count
// as one, however they are indexed; vertices whose corners differ are duplicated. A mesh that is flat everywhere keeps
// no normals.
// `groups`, one per triangle, are OBJ's smoothing groups (obj_file.h): triangles of one group are smoothed at any
// angle, those of kFlatGroup not at all, those of kNoGroup as above; no triangle is smoothed with another group's.
// `elsewhere(vertex, group)` returns the angle-weighted sum of further normals around a vertex of the mesh that belong
// to a group.
using NormalsElsewhere = std::function<Vec3d(std::uint32_t vertex, std::uint32_t group)>;
void smooth_normals(MeshData* mesh, float crease_degrees, const std::vector<std::uint32_t>* groups = nullptr,
                    const NormalsElsewhere& elsewhere = nullptr);

}  // namespace pocketray
