// Tangents for normal maps, those of clear coats included, and grains.
#pragma once
#include "import/scene_builder.h"

namespace pocketray {

// Whether a material has a normal map or a grain.
bool needs_tangents(const SceneArrays& out, std::uint32_t material);

// Those that a file gives, in world space.
std::vector<PackedTangent> pack_tangents(const std::vector<GivenTangent>& given, const Transform& to_world);

// Fills builder->out->tangents where no file gave one, if a material needs them, as MikkTSpace does [Mikkelsen 2008,
// "Simulation of wrinkled surfaces revisited", sec. 4.3]: at a vertex, the triangles' ∂P/∂u, each made perpendicular to
// the vertex normal and unit, are added by the angle that the triangle has there. Vertices of equal position, normal
// and texture coordinates count as one. Zero, for the triangle's own frame: at vertices that move; that triangles of
// both orientations in the texture share, which MikkTSpace would part; and of other materials. Tangents and the memory
// to make them count towards the import's limit.
void make_tangents(SceneBuilder* builder);

}  // namespace pocketray
