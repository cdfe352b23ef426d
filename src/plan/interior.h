// Where to stand in a room, for a scene that has no camera.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Finds the place on the floor, and the horizontal direction from it, with the longest view: the free distance along
// rays at eye height. Chooses among 144 places and 16 directions. Returns false, changing nothing, if there is no place
// with a floor, walls around and room to stand.
bool find_place_to_stand(const Scene& scene, const Box& bounds, Vec3* eye, Vec3* target);

}  // namespace pocketray
