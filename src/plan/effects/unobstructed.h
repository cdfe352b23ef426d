// Scenes in which no surface can come between another and a light, such as an empty convex room.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Returns whether every vertex and every light lie on one side of the plane of each triangle, and no light on it,
// except that a lamp, being a surface, lies in its own: then a segment from a surface to a light meets no other
// surface. Always false if triangles or lights may move, if there are more than a few triangles, or if one is a needle,
// on which rays begin too close to its neighbours.
bool is_unobstructed(const Scene& scene);

}  // namespace pocketray
