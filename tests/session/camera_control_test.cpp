#include "session/camera_control.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace pocketray;

namespace {

CameraControl control_of(const Vec3& eye, const Vec3& target, const Vec3& up) {
  Camera camera;
  camera.eye = eye, camera.target = target, camera.up = up;
  CameraControl control;
  control.scene = control.home = control.camera = camera;
  control.size = 4;
  return control;
}

}  // namespace

// Goal: a turntable turns about the vertical, whichever way its camera leans. Method: cameras upright, looking down and
// leaning to a side: height, distance and lean stay, opposite views lie opposite, a whole turn is none.
TEST_CASE("orbit_turns_about_the_vertical") {
  const Vec3 target = {1, 2, 3}, eye = {3, 5, 4};
  const Vec3 down = normalize(target - eye), right = normalize(cross(down, {0, 1, 0}));
  for (const Vec3& up : {Vec3{0, 1, 0}, normalize(cross(right, down)), normalize(Vec3{0.3f, 1, 0.2f})}) {
    const CameraControl control = control_of(eye, target, up);
    CAPTURE(up.x);
    const Camera half = orbited_camera(control, 180), quarter = orbited_camera(control, 90),
                 whole = orbited_camera(control, 360);
    auto near = [](const Vec3& a, const Vec3& b) { return length(a - b) < 1e-5f; };
    CHECK(near(half.eye, {2 * target.x - eye.x, eye.y, 2 * target.z - eye.z}));
    CHECK(near(half.up, {-up.x, up.y, -up.z}));
    CHECK(near(whole.eye, eye));
    CHECK(near(whole.up, up));
    CHECK(std::fabs(quarter.eye.y - eye.y) < 1e-5f);
    CHECK(std::fabs(dot(quarter.up, quarter.target - quarter.eye) - dot(up, target - eye)) < 1e-5f);
    CHECK(std::fabs(dot(quarter.eye - target, {eye.x - target.x, 0, eye.z - target.z})) < 1e-4f);
    CHECK(near(quarter.target, target));
  }
}

// Goal: where the vertical lies across the view, the camera's up vector takes its place. Method: z upwards.
TEST_CASE("orbit_turns_about_another_vertical") {
  const CameraControl control = control_of({3, 0, 1}, {0, 0, 0}, {0, 0, 1});
  const Camera half = orbited_camera(control, 180);
  CHECK(length(half.eye - Vec3{-3, 0, 1}) < 1e-5f);
  CHECK(half.up == Vec3{0, 0, 1});
}
