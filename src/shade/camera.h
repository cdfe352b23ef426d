// Camera rays. They go through pixel centres; row 0 on top; pixels are square.
#pragma once
#include "base/status.h"
#include "shade/frame_data.h"

namespace pocketray {

// Fails if the eye is at the target or the field of view or extent is non-finite or impossible. A view along `up` gets
// another up vector.
Status make_camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height, CameraRays* rays);

// The ray through the image point (x, y) in pixels. Its direction is unit, so t is a distance.
inline Ray camera_ray(const CameraRays& c, float x, float y) {
  float sx = 2 * x / c.width - 1, sy = 1 - 2 * y / c.height;
  Ray ray;
  ray.t_max = __builtin_inff();
  if (c.orthographic) {
    ray.origin = c.eye + c.right * sx + c.up * sy;
    ray.direction = c.forward;
  } else {
    ray.origin = c.eye;
    ray.direction = normalize(c.forward + c.right * sx + c.up * sy);
  }
  return ray;
}

}  // namespace pocketray
