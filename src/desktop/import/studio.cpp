// A photographer's studio: soft boxes in front of a backdrop that runs from a dark floor to a bright ceiling.
#include <algorithm>
#include <vector>

#include "brdf/clear_coat.h"
#include "desktop/import/environment.h"
#include "indirect/surroundings.h"
#include "scene/metallic_roughness.h"

namespace pocketray {
namespace {

// Rises from 0 below `from` to 1 above `to`.
double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// A soft box: a rectangle that faces the scene from a direction, seen at distance 1.
struct SoftBox {
  Vec3d towards;
  double half_width, half_height;  // up to half of its radiance
  Vec3d radiance;
};

// Chosen: all above the view of a camera that looks straight ahead. The brightest is in the direction of the key light,
// as the default camera sees it from the front right.
const SoftBox kBoxes[] = {
    {{-0.45, 0.95, 0.95}, 0.3, 0.27, {2.05, 2, 1.9}},                                          // key
    {{1.1, 0.9, 0.35}, 0.18, 0.38, {0.95, 1, 1.1}},                                            // fill
    {{-1.0, 0.8, -0.75}, 0.32, 0.2, {0.97, 1, 1.05}},                                          // behind, on both sides
    {{0.55, 0.85, -1.1}, 0.32, 0.2, {0.97, 1, 1.05}}, {{0, 1, 0}, 0.3, 0.3, {0.8, 0.8, 0.8}},  // overhead
};
constexpr double kEdge = 0.1;  // width over which a box fades

double share_of(const SoftBox& box, const Vec3d& direction) {
  const Vec3d axis = normalize(box.towards);
  const double ahead = dot(axis, direction);
  if (!(ahead > 0.2)) return 0;
  Vec3d right = cross(Vec3d{0, 1, 0}, axis);
  right = dot(right, right) > 0 ? normalize(right) : Vec3d{1, 0, 0};
  auto within = [&](const Vec3d& along, double half) {
    const double at = dot(along, direction) / ahead;
    return 1 - smooth_step(half - kEdge, half + kEdge, at < 0 ? -at : at);
  };
  return within(right, box.half_width) * within(cross(axis, right), box.half_height);
}

// Chosen: dielectrics have a reflectance of .04 to .08, and a lobe of √α = 0.5 smooths its reflections.
constexpr float kReflectance = 0.08f, kRoughness = 0.25f;

bool mirrors(const Scene& scene, std::uint32_t material) {
  const Material m = lobe_bounds(scene, material);
  if (!is_zero(m.mirror) || !is_zero(m.transmission) || coat_of(scene, material)) return true;
  return reflects_surroundings(m) && (max_component(m.specular) > kReflectance || m.roughness < kRoughness);
}

}  // namespace

Vec3d studio_radiance(const Vec3d& direction) {
  const double y = direction.y;
  // The floor darkens towards the scene; the backdrop brightens up to a grey ceiling.
  const double grey = y < 0 ? 0.17 - 0.1 * smooth_step(0, 0.8, -y) : 0.17 + 0.15 * smooth_step(0, 0.9, y);
  Vec3d sum = Vec3d{0.97, 1, 1.05} * grey;
  for (const SoftBox& box : kBoxes) sum += box.radiance * share_of(box, direction);
  return sum;
}

bool calls_for_studio(const Scene& scene) {
  std::vector<bool> known(scene.materials.count);
  for (const Triangle& t : scene.triangles) {
    if (known[t.material()]) continue;
    known[t.material()] = true;
    if (mirrors(scene, t.material())) return true;
  }
  return false;
}

}  // namespace pocketray
