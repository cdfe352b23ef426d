// Camera rays. They go through pixel centres; row 0 on top; pixels are square.
#pragma once
#include "accel/ray.h"
#include "base/status.h"
#include "scene/scene.h"
#include "shade/view.h"

namespace pocketray {

// Fails if the eye is at the target, or if the field of view or extent is non-finite or impossible. If the camera looks
// along `up`, another up vector is used.
Status make_camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height, CameraRays* rays);

// Contribution of column x and row y, in pixels, to the direction of a perspective ray.
inline Vec3 column_part(const CameraRays& c, float x) { return c.forward + c.right * (2 * x / c.width - 1); }
inline Vec3 row_part(const CameraRays& c, float y) { return c.up * (1 - 2 * y / c.height); }

// Ray through the image point (x, y), in pixels. Its direction is a unit vector, so t is a distance.
inline Ray camera_ray(const CameraRays& c, float x, float y) {
  Ray ray;
  ray.t_max = __builtin_inff();
  if (c.has_one_origin) {
    ray.origin = c.eye;
    ray.direction = normalize(column_part(c, x) + row_part(c, y));
  } else if (c.orthographic) {
    ray.origin = c.eye + c.right * (2 * x / c.width - 1) + row_part(c, y) + c.forward * c.near_distance;
    ray.direction = c.forward;
  } else {
    const Vec3 way = column_part(c, x) + row_part(c, y);  // to the plane at distance 1
    ray.origin = c.eye + way * c.near_distance;
    ray.direction = normalize(way);
  }
  return ray;
}

// Distance along a camera ray from the eye, or an orthographic camera's plane, to its origin.
inline float near_part(const CameraRays& c, const Vec3& direction) {
  return c.near_distance > 0 ? c.near_distance / dot(direction, c.forward) : 0;
}

// Where the ray through the middle of the picture begins.
inline Vec3 near_middle(const CameraRays& c) { return c.eye + c.forward * c.near_distance; }

// Sets the near plane if any triangle lies before it, in the picture or beside it. Otherwise the camera stays as it is:
// rays from one origin are traced in packets.
void set_near_plane(float distance, Array<const Vec3> positions, Array<const Triangle> triangles, CameraRays* rays);

// Projects a point to pixel coordinates. Returns false if it is behind the camera or projects nowhere.
bool place_in_picture(const CameraRays& camera, const Vec3& point, Vec2* place);

}  // namespace pocketray
