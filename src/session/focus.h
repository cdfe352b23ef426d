// Aims a camera at one part of a model.
#pragma once
#include <string>

#include "session/source.h"

namespace pocketray {

// Finds the bounds of the named part. Fails, listing the nearest names, if there is none.
Status find_part(const SceneSource& source, const std::string& scene, const std::string& name, Box* bounds);

// Returns a perspective camera that looks at the part from the direction in which `camera` looks at the scene, and
// shows all of it. `fov`: the vertical field of view in radians.
Camera focused_camera(const Camera& camera, const Box& bounds, float aspect, double fov);

}  // namespace pocketray
