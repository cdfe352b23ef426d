#include "shade/camera.h"

#include <cmath>

#include "base/check.h"
#include "base/limit_list.h"

namespace pocketray {

Status make_camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height, CameraRays* rays) {
  CHECK(rays != nullptr);
  CHECK(width > 0 && width <= kImageSideMax);
  CHECK(height > 0 && height <= kImageSideMax);
  for (const Vec3& v : {camera.eye, camera.target, camera.up})
    for (float x : {v.x, v.y, v.z})
      RETURN_IF_ERROR(check_limit(Quantity::coordinate, static_cast<double>(x), "a coordinate of the camera"));
  Vec3 forward = normalize(camera.target - camera.eye);
  if (is_zero(forward)) return failure("the camera's eye and target are the same point: move one of them");
  Vec3 right = normalize(cross(forward, normalize(camera.up)));
  if (is_zero(right)) {  // looking along up: any right vector works (HARDCASES row 28)
    Vec3 up;
    make_basis(forward, &right, &up);
  }
  Vec3 up = cross(right, forward);
  float half_height;
  rays->orthographic = camera.projection == Projection::orthographic;
  if (rays->orthographic) {
    RETURN_IF_ERROR(check_limit(Quantity::vertical_extent, static_cast<double>(camera.vertical_extent)));
    half_height = camera.vertical_extent * 0.5f;
  } else {
    double fov = camera.vertical_fov;
    if (!within(Quantity::field_of_view, fov))
      return failure("the vertical field of view is %g degrees: it must lie in 0.001 … 179", fov * (180 / kPi));
    half_height = static_cast<float>(det_sin(fov / 2) / det_cos(fov / 2));
  }
  rays->eye = camera.eye;
  rays->forward = forward;
  rays->up = up * half_height;
  rays->right = right * (half_height * (static_cast<float>(width) / static_cast<float>(height)));
  rays->width = static_cast<float>(width);
  rays->height = static_cast<float>(height);
  rays->near_distance = 0;
  rays->has_one_origin = !rays->orthographic;
  return success();
}

void set_near_plane(float distance, Array<const Vec3> positions, Array<const Triangle> triangles, CameraRays* rays) {
  CHECK(rays != nullptr && distance >= 0);
  rays->near_distance = 0;
  rays->has_one_origin = !rays->orthographic;
  if (!(distance > 0)) return;
  // Rays reach the plane in a pyramid around the eye, or in a box.
  const float stretch = rays->orthographic ? 1 : distance;
  Box before = empty_box();
  for (float x : {-1.0f, 1.0f})
    for (float y : {-1.0f, 1.0f}) {
      const Vec3 aside = (rays->right * x + rays->up * y) * stretch;
      before = merge(before, rays->orthographic ? rays->eye + aside : rays->eye);
      before = merge(before, rays->eye + aside + rays->forward * distance);
    }
  for (const Triangle& t : triangles) {
    Box bounds = empty_box();
    for (std::uint32_t v : t.vertices()) bounds = merge(bounds, positions[v]);
    if (!overlaps(before, bounds)) continue;
    bool is_behind = true, is_beyond = true;
    for (std::uint32_t v : t.vertices()) {
      const float depth = dot(positions[v] - rays->eye, rays->forward);
      is_behind &= depth <= 0, is_beyond &= depth >= distance;
    }
    if (is_behind || is_beyond) continue;
    rays->near_distance = distance;
    rays->has_one_origin = false;
    return;
  }
}

bool place_in_picture(const CameraRays& c, const Vec3& point, Vec2* place) {
  CHECK(place != nullptr);
  CHECK(c.width > 0 && c.height > 0);
  const Vec3 to_point = point - c.eye;
  const float depth = c.orthographic ? 1 : dot(to_point, c.forward);
  if (!(depth > 0)) return false;
  const float x = dot(to_point, c.right) / (dot(c.right, c.right) * depth);
  const float y = dot(to_point, c.up) / (dot(c.up, c.up) * depth);
  *place = {(x + 1) * 0.5f * c.width, (1 - y) * 0.5f * c.height};
  return std::isfinite(place->x) && std::isfinite(place->y);
}

}  // namespace pocketray
