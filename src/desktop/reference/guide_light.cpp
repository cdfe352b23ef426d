// Traces paths from the lights for the guide.
#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "brdf/directions.h"
#include "desktop/reference/guide.h"
#include "desktop/reference/light.h"
#include "shade/lights.h"
#include "shade/media.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kBounceCountMax = 8;
constexpr double kMirrorMargin = 0.3;  // cells; for spots on mirrors and glass
constexpr int kNearTrials = 256;       // directions in which to look for a surface near a light
constexpr double kNearMax = 1.0 / 6;   // relative to the scene's size: closer counts as near
// In units of that distance: radius of the bright spot on the surface, radius of its middle, and its margin beyond the
// points found.
constexpr double kBrightReach = 3, kMiddleReach = 1.5, kBrightMargin = 0.25;

bool is_specular(const Material& m) { return !is_zero(m.mirror) || !is_zero(m.transmission); }  // somewhere

// Traces light from a point on an emitter to a point on a mirror or glass, and beyond.
void follow_light(const Reference& reference, const ReferenceSurface& light, const Vec3d& target, Rng* rng,
                  ReferenceGuide* guide) {
  const FrameData& frame = *reference.world.frame;
  ReferenceRay ray = leave(frame, light, normalize(target - light.point), kInfinity);
  MediumStack media;
  Vec3d way = light.point;
  for (int bounce = 0; bounce < kBounceCountMax; ++bounce) {
    ReferenceHit hit = next_hit(reference.world, ray, nullptr);
    if (hit.triangle == kNone) return;
    ReferenceSurface s = reference_surface(frame, hit, ray.direction);
    const Material& m = lobes_of(s);
    if (bounce > 0 && (!is_zero(s.even) || !is_zero(m.specular)))
      remember(s.point, {way, kMirrorMargin * guide->cell_size, kByMirrors}, guide);
    if ((is_zero(m.mirror) && is_zero(s.transmission)) || m.unlit) return;
    way = s.point;
    Vec3d direction;
    if (is_zero(s.transmission)) {
      direction = mirrored(ray.direction, s);
    } else {
      ReferenceBoundary b = meet_boundary(frame, s, gather_contact(reference.world, ray, hit), ray.direction, media);
      bool reflects = next_double(rng) < max_component(b.reflectance);
      direction = reflects ? mirrored(ray.direction, s) : b.direction;
      if (!reflects) media = b.beyond;
    }
    ray = leave(frame, s, direction, kInfinity);
  }
}

// A light without area, and the part of the sphere that it lights: all of it, or a cone.
struct PunctualLight {
  Vec3d position, axis, intensity;
  double height;  // 1 − cosine of the cone's half angle; 2: the sphere
};
bool is_punctual(const LightPoint& light, LightSampler kind, PunctualLight* p) {
  bool spot = kind == find_light_sampler(Effect::spot_light);
  if (light.material != kNone || (!spot && kind != find_light_sampler(Effect::point_light))) return false;
  *p = {to_double(light.position), spot ? to_double(light.direction) : Vec3d{0, 0, 1}, to_double(light.intensity),
        spot ? 1 - static_cast<double>(light.cos_outer) : 2};
  return true;
}

// Finds the first surface that light meets in a random direction of its cone.
bool leave_light(const ReferenceWorld& world, const PunctualLight& light, Rng* rng, ReferenceRay* ray,
                 ReferenceHit* hit) {
  double below = light.height * next_double(rng), sine = std::sqrt(below * (2 - below));
  double phi = 2 * kPi * next_double(rng);
  Vec3d tangent, bitangent;
  make_basis(light.axis, &tangent, &bitangent);
  *ray = {light.position,
          tangent * (sine * det_cos(phi)) + bitangent * (sine * det_sin(phi)) + light.axis * (1 - below), 0, kInfinity};
  *hit = next_hit(world, *ray, nullptr);
  return hit->triangle != kNone;
}

double nearest_surface(const ReferenceWorld& world, const PunctualLight& light) {
  Rng rng = make_rng(kNearTrials);
  double nearest = kInfinity;
  for (int i = 0; i < kNearTrials; ++i) {
    ReferenceRay ray;
    ReferenceHit hit;
    if (leave_light(world, light, &rng, &ray, &hit)) nearest = std::fmin(nearest, hit.t);
  }
  return nearest;
}

// Power of a light so near to a surface that it makes a small bright spot there; 0: it needs no guide.
double near_power(const ReferenceWorld& world, const PunctualLight& light, double scene_size) {
  if (!(nearest_surface(world, light) < kNearMax * scene_size)) return 0;
  return light.height * max_component(light.intensity);
}

// Traces light to the surface near the light, and on by the lobes there.
void follow_near_light(const Reference& reference, const PunctualLight& light, std::uint32_t path_count,
                       std::uint32_t ordinal, ReferenceGuide* guide) {
  const FrameData& frame = *reference.world.frame;
  double nearest = nearest_surface(reference.world, light);
  Rng rng = make_rng(path_count, 1);
  for (std::uint32_t i = 0; i < path_count; ++i) {
    ReferenceRay ray;
    ReferenceHit hit;
    if (!leave_light(reference.world, light, &rng, &ray, &hit) || hit.t > kBrightReach * nearest) continue;
    bool is_middle = hit.t <= kMiddleReach * nearest;
    ReferenceSurface bright = reference_surface(frame, hit, ray.direction);
    double choice = next_double(&rng), u = next_double(&rng);
    Vec3d direction;
    if (!sample_lobes(bright, -ray.direction, choice, {u, next_double(&rng)}, &direction)) continue;
    ray = leave(frame, bright, direction, kInfinity);
    hit = next_hit(reference.world, ray, nullptr);
    if (hit.triangle != kNone)
      remember(reference_surface(frame, hit, direction).point,
               {bright.point, kBrightMargin * nearest, kByMirrors + 1 + 2 * ordinal + is_middle}, guide);
  }
}

// Calls f(light) for each light without area.
template <class Function>
void for_punctual_lights(const FrameData& frame, Function f) {
  for (int r = 0; r < frame.lights.run_count; ++r)
    for (std::uint32_t i = frame.lights.runs[r].begin; i < frame.lights.runs[r].end; ++i) {
      PunctualLight light;
      if (is_punctual(frame.lights.points[i], frame.lights.runs[r].sample, &light)) f(light);
    }
}

// Side of a square with the area of all parts.
double size_of(const Array<ReferenceEmitter>& parts) {
  double area = 0;
  for (const ReferenceEmitter& part : parts) area += part.area;
  return std::sqrt(area);
}

// Longest side of the bounds of the frame's geometry.
double scene_extent(const FrameData& frame) {
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double low = kInfinity, high = -kInfinity;
    for (const Vec3& p : frame.geometry.positions)
      low = std::fmin(low, static_cast<double>(p[axis])), high = std::fmax(high, static_cast<double>(p[axis]));
    extent = std::fmax(extent, high - low);
  }
  return extent;
}

void follow_area_lights(const Reference& reference, std::uint32_t path_count, Arena* arena, ReferenceGuide* guide) {
  CHECK(!reference.emitters.empty());
  const FrameData& frame = *reference.world.frame;
  std::size_t mark = arena_mark(*arena);
  Array<ReferenceEmitter> targets = arena_array<ReferenceEmitter>(arena, frame.scene->triangles.count);
  targets.count = find_parts(
      frame, [](const Material& m) { return is_specular(m) ? 1.0 : 0.0; }, targets.data);
  if (targets.count > 0)
    guide->cell_size =
        std::fmax(std::fmin(size_of(reference.emitters) / 4, size_of(targets) / 16), guide->cell_size / 16);
  Rng rng = make_rng(path_count);
  for (std::uint32_t i = 0; i < path_count && targets.count > 0; ++i) {
    double u = next_double(&rng), v = next_double(&rng);
    ReferencePlace from = pick_place(frame, reference.emitters, {u, v});
    u = next_double(&rng), v = next_double(&rng);
    ReferencePlace to = pick_place(frame, targets, {u, v});
    Vec3d direction = to.point - from.point;
    ReferenceSurface light = reference_surface(frame, {0, from.u, from.v, from.triangle}, -direction);
    if (is_zero(light.emission) || !(dot(light.geometric, direction) > 0)) continue;
    follow_light(reference, light, to.point, &rng, guide);
  }
  arena_release(arena, mark);
}

}  // namespace

std::size_t reference_guide_need(std::uint32_t triangle_count) {
  return reference_cells_need() + arena_need<ReferenceEmitter>(triangle_count);
}

void make_reference_guide(const FrameData& frame, std::uint32_t path_count, Arena* arena, Reference* reference) {
  if (path_count == 0) return;
  bool any_mirror = false;
  for (const Material& m : frame.scene->materials) any_mirror = any_mirror || is_specular(m);
  any_mirror = any_mirror && !reference->emitters.empty();
  CHECK(arena != nullptr && reference->world.frame == &frame);
  double scene_size = scene_extent(frame), total = 0;
  for_punctual_lights(frame,
                      [&](const PunctualLight& light) { total += near_power(reference->world, light, scene_size); });
  if (!any_mirror && total == 0) return;
  ReferenceGuide* guide = &reference->guide;
  make_reference_cells(arena, guide);
  guide->cell_size = scene_size / 16;
  if (any_mirror) follow_area_lights(*reference, path_count, arena, guide);
  std::uint32_t ordinal = 0;
  for_punctual_lights(frame, [&](const PunctualLight& light) {
    double power = near_power(reference->world, light, scene_size), share = std::fmin(1, 4 * power / total);
    if (power > 0)
      follow_near_light(*reference, light, static_cast<std::uint32_t>(path_count * share), ordinal++, guide);
  });
}

}  // namespace pocketray
