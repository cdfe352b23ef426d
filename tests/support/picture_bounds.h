// Where points appear in a camera's picture.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/scene.h"

namespace pocketray {

// −1 … 1 from edge to edge.
struct PictureBounds {
  float left = std::numeric_limits<float>::infinity(), right = -left, bottom = left, top = -left;
  bool in_front = true;  // no point is behind the eye
  float fill() const { return std::max(right - left, top - bottom) / 2; }
  bool inside(float edge) const { return in_front && left >= -edge && right <= edge && bottom >= -edge && top <= edge; }
};

inline void add_point(const Camera& camera, float aspect, const Vec3& point, PictureBounds* bounds) {
  const Vec3d backward = normalize(to_double(camera.eye) - to_double(camera.target));
  const Vec3d right = normalize(cross(to_double(camera.up), backward)), up = cross(backward, right);
  const Vec3d p = to_double(point) - to_double(camera.eye);
  const double depth = -dot(p, backward), slope = std::tan(static_cast<double>(camera.vertical_fov) / 2);
  bounds->in_front = bounds->in_front && depth > 0;
  const float x = static_cast<float>(dot(p, right) / (depth * slope * static_cast<double>(aspect))),
              y = static_cast<float>(dot(p, up) / (depth * slope));
  bounds->left = std::min(bounds->left, x), bounds->right = std::max(bounds->right, x);
  bounds->bottom = std::min(bounds->bottom, y), bounds->top = std::max(bounds->top, y);
}

template <class Points>
PictureBounds picture_bounds(const Camera& camera, float aspect, const Points& points) {
  PictureBounds bounds;
  for (const Vec3& p : points) add_point(camera, aspect, p, &bounds);
  return bounds;
}

}  // namespace pocketray
