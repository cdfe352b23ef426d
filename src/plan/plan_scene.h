// What a scene lacks and gets: a camera that frames it, and lights.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Bounds of all triangles.
Box scene_bounds(const Scene& scene);

// A camera that frames the box: from the front, a little above and to the right, 40° high, everything in view.
Camera framing_camera(const Box& bounds, float aspect);

// The lights of a scene that has none: a key from the upper left of the camera and a weaker fill from its right, both
// directional; they come with an ambient term of a tenth of the key, see default_ambient().
constexpr std::uint32_t kDefaultLightCount = 2;
void default_lights(const Camera& camera, Light* lights);
Vec3 default_ambient();

// Whether the scene shows without default lights: it has a light, an ambient term or an emissive surface, or all of its
// surfaces are unlit.
bool has_light(const Scene& scene);

}  // namespace pocketray
