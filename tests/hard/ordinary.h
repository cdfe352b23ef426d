// Ordinary methods, as textbooks have them, to show what hard cases do to them.
#pragma once
#include <cmath>

#include "accel/ray.h"
#include "base/vec3.h"

namespace pocketray {
namespace ordinary {

// [Möller and Trumbore 1997], two-sided, with its usual absolute epsilon. Returns whether the ray hits, at *t > 0.
inline bool moeller_trumbore(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c, float* t) {
  constexpr float kEpsilon = 1e-8f;
  const Vec3 one = b - a, other = c - a, p = cross(ray.direction, other);
  const float determinant = dot(one, p);
  if (std::fabs(determinant) < kEpsilon) return false;
  const float inverse = 1 / determinant;
  const Vec3 s = ray.origin - a;
  const float u = dot(s, p) * inverse;
  if (u < 0 || u > 1) return false;
  const Vec3 q = cross(s, one);
  const float v = dot(ray.direction, q) * inverse;
  if (v < 0 || u + v > 1) return false;
  *t = dot(other, q) * inverse;
  return *t > 0;
}

// The slab test of [Williams et al. 2005, JGT 10(1)], which has no padding. Returns whether the ray enters the box.
inline bool slabs(const Ray& ray, const Vec3& low, const Vec3& high) {
  float enter = 0, leave = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float inverse = 1 / ray.direction[axis];
    const bool backward = inverse < 0;
    const float near = ((backward ? high : low)[axis] - ray.origin[axis]) * inverse;
    const float far = ((backward ? low : high)[axis] - ray.origin[axis]) * inverse;
    if (axis > 0 && (enter > far || near > leave)) return false;
    if (axis == 0 || near > enter) enter = near;
    if (axis == 0 || far < leave) leave = far;
  }
  return enter < ray.t_max && leave > 0;
}

// [Woop, Benthin, Wald 2013] as published, in plain floats with double at edges, of the raw coordinates of a ray and a
// triangle: compiled as the rest, or with products and sums contracted (FMA), as compilers do by default.
bool woop_as_published(const float* origin, const float* direction, const float* a, const float* b, const float* c);
bool woop_contracted(const float* origin, const float* direction, const float* a, const float* b, const float* c);
// Returns whether this build contracts and this CPU can run it.
bool has_contraction();

}  // namespace ordinary
}  // namespace pocketray
