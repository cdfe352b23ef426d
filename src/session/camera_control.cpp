#include "session/camera_control.h"

#include "base/check.h"
#include "base/limit_list.h"

namespace pocketray {
namespace {

constexpr Vec3 kVertical = {0, 1, 0};
constexpr float kLeanMax = 0.05f;  // cosine; a camera that leans more has another vertical

// Rotates v about a unit axis by an angle in radians (Rodrigues' formula).
Vec3 rotate(const Vec3& v, const Vec3& axis, double angle) {
  float c = static_cast<float>(det_cos(angle)), s = static_cast<float>(det_sin(angle));
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

// Turns a view vector about up and the horizontal axis, keeping off the poles.
Vec3 turn(const Vec3& view, const Vec3& up, double yaw, double pitch) {
  Vec3 turned = rotate(view, up, yaw);
  Vec3 right = normalize(cross(turned, up));
  if (is_zero(right)) return turned;
  Vec3 tilted = rotate(turned, right, pitch);
  float sine = dot(normalize(tilted), up);
  // Within 8° of a pole.
  return sine > 0.99f || sine < -0.99f ? turned : tilted;
}

// True if the camera is within the limits of local rendering and of servers.
bool is_within_limits(const Camera& c) {
  for (const Vec3& v : {c.eye, c.target, c.up})
    for (float x : {v.x, v.y, v.z})
      if (!within(Quantity::coordinate, x)) return false;
  return within(Quantity::vertical_extent, c.vertical_extent);
}

}  // namespace

CameraControl make_camera_control(const Camera& camera, const Box& bounds) {
  CameraControl control;
  control.scene = control.home = control.camera = camera;
  float size = is_empty(bounds) ? 0 : length(extent(bounds));
  control.size = size > 0 ? size : length(camera.target - camera.eye);
  // A file's camera has only a direction, but orbiting needs a target: the point at the distance of the scene's centre.
  Vec3 forward = normalize(camera.target - camera.eye);
  if (!is_empty(bounds)) {
    float distance = dot(center(bounds) - camera.eye, forward);
    if (distance > 0) control.home.target = control.camera.target = camera.eye + forward * distance;
  }
  return control;
}

bool move_camera(CameraControl* control, const CameraInput& in, float seconds) {
  CHECK(control != nullptr && control->size >= 0);
  if (in.right == 0 && in.up == 0 && in.forward == 0 && in.sideways == 0 && in.rise == 0) return false;
  Camera& c = control->camera;
  const Camera before = c;
  Vec3 up = normalize(c.up);
  double quarter = radians(90) * static_cast<double>(seconds);
  if (control->mode == CameraMode::orbit) {
    Vec3 view = turn(c.target - c.eye, up, in.right * quarter, -in.up * quarter);
    float zoom = static_cast<float>(det_exp(-static_cast<double>(in.forward) * static_cast<double>(seconds)));
    // No closer than a thousandth of the scene, where turning about the target still turns the view.
    if (length(view) * zoom > control->size * 1e-3f) view = view * zoom;
    c.eye = c.target - view;
    c.vertical_extent *= c.projection == Projection::orthographic ? zoom : 1;
    if (!is_within_limits(c)) c = before;
    return true;
  }
  Vec3 view = turn(c.target - c.eye, up, -in.right * quarter, in.up * quarter);
  Vec3 ahead = normalize(view), right = normalize(cross(ahead, up));
  Vec3 step = (ahead * in.forward + right * in.sideways + up * in.rise) * (control->size * 0.5f * seconds);
  c.eye += step;
  c.target = c.eye + view;
  if (!is_within_limits(c)) c = before;
  return true;
}

Camera orbited_camera(const CameraControl& control, float degrees) {
  CameraControl turned = control;
  reset_camera(&turned);
  // A camera that looks up or down may lean: the scene turns about the vertical anyway.
  Camera& camera = turned.camera;
  const Vec3 up = normalize(camera.up);
  if (up.y > kLeanMax && up.y < 1) {
    const double angle = radians(static_cast<double>(degrees));
    camera.eye = camera.target - rotate(camera.target - camera.eye, kVertical, angle);
    camera.up = rotate(up, kVertical, angle);
    camera.node = kNone;
    if (!is_within_limits(camera)) camera = control.home;
    return camera;
  }
  turned.mode = CameraMode::orbit;
  CameraInput right;
  right.right = 1;
  move_camera(&turned, right, degrees / 90);
  turned.camera.node = kNone;
  return turned.camera;
}

void reset_camera(CameraControl* control) { control->camera = control->home; }

}  // namespace pocketray
