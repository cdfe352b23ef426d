// From a camera to rays. Pixel centres; row 0 on top; pixels are square.
#pragma once
#include "base/status.h"
#include "shade/frame_data.h"

namespace pocketray {

// Fails for an eye at the target, a non-finite or impossible field of view or extent; a view along `up` picks another
// up.
Status make_camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height, CameraRays* rays);

// The ray through the image point (x, y) in pixels. Its direction is unit, so t is distance.
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
