// Whether a scene is seen from inside, and from which side it shows most otherwise. Each costs some looks at every
// triangle, when a scene without a camera or lights is baked, or opened without having been.
#pragma once
#include "scene/scene.h"

namespace pocketray {

struct Room {
  // Surfaces that face inward enclose most of the scene's bounds, or stand around their middle (walls with two sides).
  bool is_room = false;
  bool has_thick_walls = false;
  Vec3 opening = {0, 0, 0};  // unit vector out through a thin-walled room's open side; zero if it is closed
};
Room find_room(const Scene& scene, const Box& bounds);

// Distance from a point to the first triangle along a unit direction; infinite if there is none.
float free_distance(const Scene& scene, const Vec3& from, const Vec3& direction);

// Whether surfaces that emit without a texture, however dim, light others: a tenth of their light falls on some.
bool lamps_light_up(const Scene& scene);

// The vector sum of all triangles' areas along their fronts: zero for closed surfaces, otherwise towards the side that
// open ones, as backdrops, show.
Vec3d shown_area(const Scene& scene, const Box& bounds);

}  // namespace pocketray
