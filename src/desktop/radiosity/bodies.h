// Which triangles enclose something: what lies behind their backs is inside. Behind the back of a sheet, such as a lamp
// that shines on one side, lies the same room.
#pragma once
#include <vector>

#include "scene/scene.h"

namespace pocketray {

// For each triangle, whether it belongs to a body: triangles that share edges, hardly any of which are open.
std::vector<char> find_bodies(const Scene& scene);

}  // namespace pocketray
