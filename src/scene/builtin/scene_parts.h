// Helpers of the built-in scenes: small arrays from the arena, materials, lights.
#pragma once
#include <cstring>

#include "base/arena.h"
#include "base/fmath.h"
#include "scene/scene.h"

namespace pocketray {

constexpr std::size_t parts_need(std::size_t materials, std::size_t lights, std::size_t cameras) {
  return arena_need<Material>(materials) + arena_need<Light>(lights) + arena_need<Camera>(cameras);
}

// Array of `count` default elements.
template <class T>
Array<T> default_array(Arena* arena, std::size_t count) {
  Array<T> array = arena_array<T>(arena, count);
  for (T& element : array) element = T();
  return array;
}

inline void name_scene(Scene* scene, const char* name) {
  *scene = Scene();
  std::strncpy(scene->info.name, name, sizeof scene->info.name - 1);
}

inline void set_camera(Arena* arena, Scene* scene, const Vec3& eye, const Vec3& target, double vertical_fov_degrees) {
  Array<Camera> cameras = default_array<Camera>(arena, 1);
  cameras[0].eye = eye;
  cameras[0].target = target;
  cameras[0].vertical_fov = static_cast<float>(radians(vertical_fov_degrees));
  scene->cameras = cameras;
}

inline Material matte(const Vec3& diffuse) {
  Material material;
  material.diffuse = diffuse;
  return material;
}
inline Material glossy(const Vec3& diffuse, const Vec3& specular, float exponent) {
  Material material = matte(diffuse);
  material.specular = specular;
  material.exponent = exponent;
  return material;
}
inline Material emitter(const Vec3& emission, const Vec3& diffuse) {
  Material material = matte(diffuse);
  material.emission = emission;
  return material;
}

// Full intensity within `inner_degrees` of the axis, none beyond `outer_degrees`.
inline Light spot_light(const Vec3& from, const Vec3& to, const Vec3& intensity, double inner_degrees,
                        double outer_degrees) {
  Light light;
  light.kind = LightKind::spot;
  light.position = from;
  light.direction = normalize(to - from);
  light.intensity = intensity;
  light.cos_inner = static_cast<float>(det_cos(radians(inner_degrees)));
  light.cos_outer = static_cast<float>(det_cos(radians(outer_degrees)));
  return light;
}

}  // namespace pocketray
