// What a scene lacks and gets: a camera that frames it, and lights.
#pragma once
#include "scene/scene.h"

namespace pocketray {

// Bounds of all triangles.
Box scene_bounds(const Scene& scene);

// A camera that frames the box from the unit direction `backward`, 40° high, everything in view.
Camera framing_camera(const Box& bounds, float aspect, const Vec3& backward);
// A camera that stands inside the box and looks across it, 60° high.
Camera inside_camera(const Box& bounds);

// Whether the scene is a room: its surfaces face inward and enclose most of its bounds. `opening` is then the unit
// vector out through its open side, or zero where it is closed.
bool is_room(const Scene& scene, const Box& bounds, Vec3* opening);

// The camera of a scene that has none: inside a closed room, in front of an open one, else framing from the front, a
// little above and to the right.
Camera default_camera(const Scene& scene, float aspect);
// Whether what a model brings lights it: a light, or a surface that emits more than display white.
bool lights_itself(const Scene& scene);

// The lights of a scene that has none, or asks for them: a key from the upper left of the camera and a weaker fill from
// its right, both directional; in a room a point light below the ceiling and one at the camera. An ambient term comes
// with them.
constexpr std::uint32_t kDefaultLightCount = 2;
void default_lights(const Scene& scene, const Camera& camera, Light* lights);
Vec3 default_ambient();
Vec3 default_background();

// Whether the scene shows without default lights: it has a light, an ambient term or an emissive surface, or all of its
// surfaces are unlit.
bool has_light(const Scene& scene);

}  // namespace pocketray
