#include "plan/plan_scene.h"

#include "base/fmath.h"

namespace pocketray {

Box scene_bounds(const Scene& scene) {
  Box box = empty_box();
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertex) box = merge(box, scene.positions[v]);
  return box;
}

Camera framing_camera(const Box& bounds, float aspect) {
  Camera camera;
  if (is_empty(bounds)) return camera;
  camera.vertical_fov = static_cast<float>(radians(40));
  camera.target = center(bounds);
  Vec3 half = extent(bounds) * 0.5f;
  Vec3 backward = normalize(Vec3{0.45f, 0.35f, 1.0f});
  Vec3 right = normalize(cross(Vec3{0, 1, 0}, backward)), up = cross(backward, right);
  // Each corner c must project inside: |c·up| ≤ (distance − c·backward)·tan(fov/2), likewise to the right.
  float tan_half = static_cast<float>(det_sin(radians(20)) / det_cos(radians(20)));
  float distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 c = {corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y, corner & 4 ? half.z : -half.z};
    float vertical = std::fabs(dot(c, up)) / tan_half, horizontal = std::fabs(dot(c, right)) / (tan_half * aspect);
    float need = dot(c, backward) + (vertical > horizontal ? vertical : horizontal);
    if (need > distance) distance = need;
  }
  if (!(distance > 0)) distance = max_component(abs(camera.target)) > 0 ? max_component(abs(camera.target)) : 1;
  camera.eye = camera.target + backward * (distance * 1.05f);
  return camera;
}

void default_lights(const Camera& camera, Light* lights) {
  Vec3 backward = normalize(camera.eye - camera.target);
  Vec3 right = normalize(cross(camera.up, backward));
  if (is_zero(right)) make_basis(backward, &right, &right);
  Vec3 up = cross(backward, right);
  lights[0] = lights[1] = Light();
  lights[0].kind = lights[1].kind = LightKind::directional;
  lights[0].direction = -normalize(backward * 0.8f + up * 0.9f - right * 0.7f);
  lights[0].intensity = {2.6f, 2.5f, 2.35f};
  lights[1].direction = -normalize(backward * 0.7f + up * 0.2f + right * 0.9f);
  lights[1].intensity = {0.55f, 0.62f, 0.75f};
}

Vec3 default_ambient() { return {0.09f, 0.09f, 0.1f}; }

bool has_light(const Scene& scene) {
  if (scene.lights.count || !is_zero(scene.info.ambient)) return true;
  bool needs_light = false;
  for (const Triangle& t : scene.triangles) {  // what no triangle uses gives no light
    const Material& m = scene.materials[t.material];
    if (!is_zero(m.emission)) return true;
    needs_light |= !m.unlit;
  }
  return !needs_light;
}

}  // namespace pocketray
