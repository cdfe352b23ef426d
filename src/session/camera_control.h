// Orbit and fly cameras, moved by a handheld's buttons. Pure: no clock, no platform.
#pragma once
#include "base/box.h"
#include "scene/scene.h"

namespace pocketray {

// Buttons held down.
struct CameraInput {
  float right = 0, up = 0;       // −1 … 1: turn
  float forward = 0;             // −1 … 1: closer or farther (orbit), ahead or back (fly)
  float sideways = 0, rise = 0;  // −1 … 1: fly only
};

enum class CameraMode { orbit, fly };

struct CameraControl {
  CameraMode mode = CameraMode::orbit;
  Camera scene;    // the scene's own, bit for bit
  Camera home;     // its view, with the target at the centre of orbiting
  Camera camera;   // current
  float size = 1;  // of the scene; speeds scale with it
};

CameraControl make_camera_control(const Camera& camera, const Box& bounds);
// Moves for `seconds`; returns true if anything changed. Orbit: around the target, 90° per second, keeping the pole on
// top. Fly: turns on the spot, moves half the scene's size per second.
bool move_camera(CameraControl* control, const CameraInput& input, float seconds);
// Returns the scene's own view, orbited around its target by `degrees`, about the vertical or, if that lies across the
// view, about its up vector; not attached to any moving node.
Camera orbited_camera(const CameraControl& control, float degrees);
// Restores the scene's own view.
void reset_camera(CameraControl* control);

}  // namespace pocketray
