// Decides whether a scene is seen from inside, and otherwise from which side it shows most. Both test every triangle a
// few times, when a scene without a camera or lights is baked, or opened unbaked.
#pragma once
#include "scene/scene.h"

namespace pocketray {

struct Room {
  // Surfaces that face inward enclose most of the scene's bounds, or two-sided walls stand around their middle.
  bool is_room = false;
  bool has_thick_walls = false;
  Vec3 opening = {0, 0, 0};  // unit vector out through the open side of a thin-walled room; zero if it is closed
};
Room find_room(const Scene& scene, const Box& bounds);

// Distance from a point to the first triangle along a unit direction; infinite if there is none.
float free_distance(const Scene& scene, const Vec3& from, const Vec3& direction);

// Returns whether untextured surfaces that emit, however dim, light others: a tenth of their light falls on some.
bool lamps_light_up(const Scene& scene);

// Vector sum of all triangles' areas along their front normals: zero for closed surfaces; otherwise it points to the
// side that open ones, such as backdrops, show.
Vec3d shown_area(const Scene& scene, const Box& bounds);

}  // namespace pocketray
