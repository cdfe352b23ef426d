// Tangents for normal maps, including those of clear coats, and for grains.
#pragma once
#include "desktop/import/scene_builder.h"

namespace pocketray {

// Returns whether a material has a normal map or a grain.
bool needs_tangents(const SceneArrays& out, std::uint32_t material);

// Converts a file's tangents to world space.
std::vector<PackedTangent> pack_tangents(const std::vector<GivenTangent>& given, const Transform& to_world);

// Fills builder->out->tangents where the file gives none, if a material needs them, as MikkTSpace does [Mikkelsen 2008,
// "Simulation of wrinkled surfaces revisited", sec. 4.3]: a vertex sums the triangles' ∂P/∂u, each made perpendicular
// to the vertex normal and unit, weighted by the triangle's angle there. Vertices of equal position, normal and texture
// coordinates count as one. Zero, which selects the triangle's own frame: at vertices that move; at vertices shared by
// triangles of both orientations in the texture, which MikkTSpace would split; and for other materials. Tangents and
// the memory to make them count towards the import's limit.
void make_tangents(SceneBuilder* builder);

}  // namespace pocketray
