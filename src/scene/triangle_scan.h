// Quick scans of all triangles, a few instructions each.
#pragma once
#include "scene/scene.h"

namespace pocketray {

std::uint32_t largest_vertex(Array<const Triangle> triangles);  // 0 without triangles
bool any_uses_vertex(Array<const Triangle> triangles, std::uint32_t vertex);

// No material's index is larger; one may be smaller than all bounds allow. 0 without triangles.
std::uint32_t material_bound(Array<const Triangle> triangles);
// The first triangle after `index` that has another material than the one before it; the number of triangles if none
// has.
std::uint32_t next_material(Array<const Triangle> triangles, std::uint32_t index);

}  // namespace pocketray
