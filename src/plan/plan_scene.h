// Defaults for scenes without a camera or lights.
#pragma once
#include "plan/framing.h"
#include "scene/scene.h"

namespace pocketray {

// Bounds of all triangles.
Box scene_bounds(const Scene& scene);

// A camera inside the box that looks across it.
Camera inside_camera(const Box& bounds, double vertical_fov = kInsideFieldOfView);

// Returns the scene's stored view, or measures it by a few looks at every triangle. `bounds`: scene_bounds().
DefaultView find_default_view(const Scene& scene, const Box& bounds);
// Returns the scene's stored framing of an animation (kNone: at rest), or measures it at time 0. `view`:
// find_default_view().
Framing find_framing(const Scene& scene, const DefaultView& view, const Box& bounds, std::uint32_t animation = 0);
// Measures where to stand in a room, or how far a scene reaches that is seen from outside.
Framing measure_framing(const Scene& scene, const DefaultView& view, const Box& bounds);
// Adds the scene's triangles in some pose.
void add_reach(const Scene& scene, Array<const Vec3> positions, ReachMeter* meter);

// The camera of a scene without one: inside a closed room, in front of an open one, otherwise framing the scene from
// slightly above and to the right of the front, or of another side if open surfaces show their backs to the front.
// `vertical_fov`: 0 chooses it.
Camera default_camera(const DefaultView& view, const Framing& framing, const Box& bounds, float aspect,
                      double vertical_fov = 0);
// Returns whether a model lights itself: it has a light, a surface that emits more than display white, or dimmer lamps
// that light other surfaces. (A glow that falls on none, such as a display's, is not enough to see a model by.)
bool lights_itself(const Scene& scene);

// The lights of a scene without any, or one that asks for default lights: a key from the upper left of the camera and a
// weaker fill from its right, both directional; in a room, a point light below the ceiling and one at the camera. An
// ambient term comes with them.
constexpr std::uint32_t kDefaultLightCount = 2;
void default_lights(const DefaultView& view, const Box& bounds, const Camera& camera, Light* lights);
// Fraction of the default lights kept in a studio (import/environment.h), an environment that accompanies them. Chosen:
// a white surface that faces the key is as bright as without a studio, within a tenth.
constexpr float kStudioLightShare = 0.5f;
// A light from high above that replaces these, whatever the camera.
Light default_sun();
Vec3 default_ambient();
Vec3 default_background();

// Returns whether the scene is visible without default lights: it has a light, an ambient term, an environment or an
// emissive surface, or all its surfaces are unlit.
bool has_light(const Scene& scene);

// Removes the environment. Its mean stays as an ambient term, except for a studio, and for an environment that was the
// only light: default lights replace these.
void leave_out_environment(Scene* scene);

}  // namespace pocketray
