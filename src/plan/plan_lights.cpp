#include "plan/plan_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/clear_coat.h"
#include "indirect/environment.h"
#include "plan/area_light.h"
#include "scene/metallic_roughness.h"
#include "shade/lights.h"

namespace pocketray {
namespace {

constexpr Effect kKinds[] = {Effect::point_light, Effect::spot_light, Effect::directional_light, Effect::area_light};
static_assert(sizeof kKinds / sizeof kKinds[0] == sizeof FrameData::light_runs / sizeof(LightRun), "a run for each");

bool is_emissive(const Material& m) { return !is_zero(m.emission); }

Effect effect_of(LightKind kind) {
  return kind == LightKind::point  ? Effect::point_light
         : kind == LightKind::spot ? Effect::spot_light
                                   : Effect::directional_light;
}

LightPoint to_point(const Light& light) {
  LightPoint p = {};
  p.position = light.position;
  p.direction = light.direction;
  p.intensity = light.intensity;
  p.range = light.range;
  p.cos_inner = light.cos_inner;
  p.cos_outer = light.cos_outer;
  p.material = kNone;
  return p;
}

// Smallest squared distance between boxes.
float box_distance_square(const Box& a, const Box& b) {
  Vec3 d = max(max(b.low - a.high, a.low - b.high), Vec3{0, 0, 0});
  return dot(d, d);
}

// A light that shines on triangles and boxes.
struct LightReach {
  const FrameData* frame;
  const LightPoint* light;
  bool is_area;
  Box positions;  // of all that it is
};

// Upper bound of the irradiance within a box that reaches as high over the emitter's plane; falls as the box shrinks.
float irradiance_within(const LightReach& reach, const Box& box, float height) {
  const LightPoint& light = *reach.light;
  const float square = box_distance_square(box, reach.positions);
  float scale = 1;
  if (reach.is_area) {  // cos ≤ height / distance
    if (!(height > 0)) return 0;
    const float distance = std::sqrt(square);
    if (height < distance) scale = height / distance;
  }
  if (light.range > 0 && square > light.range * light.range) return 0;
  return max_component(light.intensity) * scale / square;
}

float triangle_irradiance(const void* context, std::uint32_t triangle) {
  const LightReach& reach = *static_cast<const LightReach*>(context);
  const Triangle& t = reach.frame->scene->triangles[triangle];
  if (t.material() == reach.light->material) return 0;
  Box box = empty_box();
  float height = 0;
  for (std::uint32_t v : t.vertices()) {
    const Vec3& p = reach.frame->positions[v];
    box = merge(box, p);
    if (!reach.is_area) continue;
    float h = dot(p - reach.light->position, reach.light->direction);
    if (reach.light->two_sided) h = std::fabs(h);
    if (h > height) height = h;
  }
  return irradiance_within(reach, box, height);
}

float box_irradiance(const void* context, const Box& box) {
  const LightReach& reach = *static_cast<const LightReach*>(context);
  const Vec3 &from = reach.light->position, &direction = reach.light->direction;
  float height = 0;
  if (reach.is_area) {
    // The sums of the largest and smallest products are the corners' heights, rounded as those of any vertex.
    const Vec3 low = (box.low - from) * direction, high = (box.high - from) * direction;
    const Vec3 most = max(low, high), least = min(low, high);
    height = most.x + most.y + most.z;
    if (reach.light->two_sided) height = std::max(height, -(least.x + least.y + least.z));
  }
  return irradiance_within(reach, box, height);
}

// Upper bound of a light's irradiance on any triangle but its own; `positions` holds all that it is.
float irradiance_bound(const FrameData& frame, const LightPoint& light, Effect kind, const Box& positions) {
  const float intensity = max_component(light.intensity);
  if (!(intensity > 0)) return 0;
  if (kind == Effect::directional_light) return intensity;
  const LightReach reach = {&frame, &light, kind == Effect::area_light, positions};
  const float most = frame.accel_info->largest(frame.accel, {&reach, box_irradiance, triangle_irradiance});
  return most < kRadianceMax ? most : kRadianceMax;
}

// The same for a lamp in closed form, as if one of its points had all its light.
float lamp_bound(const FrameData& frame, const LightPolygon& polygon, LightPoint point) {
  if (!polygon.corner_count) return 0;
  Box box = empty_box();
  for (std::uint32_t i = 0; i < polygon.corner_count; ++i) box = merge(box, polygon.corners[i]);
  point.position = polygon.corners[0], point.direction = polygon.normal;
  constexpr float most = std::numeric_limits<float>::max();
  point.intensity = min(point.intensity * static_cast<float>(frame.settings.points_per_area_light), {most, most, most});
  const float surrounded = kPiF * max_component(polygon.radiance);
  return std::min(surrounded, irradiance_bound(frame, point, Effect::area_light, box));
}

// To a sixteenth of the next power of two: frames of an animation, whose lights and surfaces move a little, have the
// same bound and so leave out the same rays.
float round_up(float bound) {
  int exponent;
  float mantissa = std::frexp(bound, &exponent);
  return std::isfinite(bound) ? std::ldexp(std::ceil(mantissa * 16) / 16, exponent) : bound;
}

}  // namespace

Status light_point_count(const Scene& scene, const Settings& settings, EffectMask mask, std::uint32_t* count) {
  CHECK(count != nullptr);
  std::uint64_t n = 0;
  for (const Light& light : scene.lights) n += has(mask, effect_of(light.kind));
  if (has(mask, Effect::area_light))
    for (const Material& m : scene.materials)
      if (is_emissive(m)) n += settings.points_per_area_light;
  if (n > kPointLightCountMax)
    return failure("the scene's lights need %llu light points, at most %u are supported: use fewer per area light",
                   static_cast<unsigned long long>(n), kPointLightCountMax);
  *count = static_cast<std::uint32_t>(n);
  return success();
}

void place_lights(Array<const Light> lights, Array<const Material> lamps, Array<LightPoint> points, FrameData* frame) {
  CHECK(frame != nullptr && frame->scene != nullptr);
  CHECK_EQ(lamps.count, frame->scene->materials.count);
  std::uint32_t count = 0;
  frame->light_run_count = 0;
  for (Effect kind : kKinds) {
    if (!has(frame->mask, kind)) continue;
    std::uint32_t begin = count;
    if (kind == Effect::area_light) {
      for (std::uint32_t m = 0; m < lamps.count; ++m)
        if (is_emissive(lamps[m])) count += place_area_light(*frame, m, points.data + count);
    } else {
      for (const Light& light : lights)
        if (effect_of(light.kind) == kind) points[count++] = to_point(light);
    }
    CHECK_LE(count, points.count);
    if (count > begin) frame->light_runs[frame->light_run_count++] = {begin, count, find_light_sampler(kind), nullptr};
  }
  frame->lights = {points.data, count};
}

// Upper bound of what a coat of strength 1 reflects of the surroundings.
static float coat_glow_bound(const FrameData& frame, const Material& coat, bool lit_by_environment) {
  if (lit_by_environment) return environment_bound(*frame.scene, coat, frame.mask);
  return has(frame.mask, Effect::ambient_gloss) ? reflected_surroundings_bound(frame.scene->info, coat) : 0;
}

RadianceBounds radiance_bounds(const FrameData& frame) {
  const Scene& scene = *frame.scene;
  CHECK(scene.material_maps.empty() || scene.material_maps.count == scene.materials.count);
  float glow = 0, reflectance = 0, scattering = 0, virtual_light = 0;
  const bool lit_by_environment = environment_lights(scene, frame.mask, frame.settings.indirect);
  if (has(frame.mask, Effect::instant_radiosity))
    virtual_light = virtual_lights_of(frame.indirect)->irradiance_max / kPiF;
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    const bool mapped = has(frame.mask, Effect::metallic_roughness) && scene.material_maps.count;
    const Material m = mapped ? lobe_bounds(scene.materials[i], scene.material_maps[i]) : scene.materials[i];
    bool shines = m.unlit && has(frame.mask, Effect::emission);
    float own = max_component(m.emission) + (shines ? max_component(m.diffuse) : indirect_bound(scene, m, frame.mask));
    if (!shines) own += max_component(m.diffuse) * virtual_light;
    if (lit_by_environment)
      own += environment_bound(scene, m, frame.mask);
    else if (has(frame.mask, Effect::ambient_gloss))
      own += reflected_surroundings_bound(scene.info, m);
    const ClearCoat* coat = has(frame.mask, Effect::clear_coat) ? coat_of(scene, i) : nullptr;
    if (coat) own += coat->strength * coat_glow_bound(frame, coat_bounds(*coat), lit_by_environment);
    if (own > glow) glow = own;
    float passes =
        max_component(m.mirror) + (is_zero(m.transmission) ? 0 : max_component(max(m.transmission, Vec3{1, 1, 1})));
    if (coat) passes += coat->strength * coat_mirror_share(coat->roughness_low);
    if (passes > reflectance) reflectance = passes;
    float f = max_component(m.diffuse) / kPiF;
    CHECK_LT(m.brdf, kBrdfCount);
    const BrdfInfo* lobe = kBrdfList[m.brdf];
    if (has(frame.mask, Effect::anisotropy) && has_grain(scene, i)) lobe = lobe->with_grain;
    if (!is_zero(m.specular)) f = f * lobe->diffuse_max + max_component(lobe->peak(m));
    if (coat && has_lobe(*coat)) f += coat->strength * max_component(kBrdfList[kGgx]->peak(coat_bounds(*coat)));
    if (f > scattering) scattering = f;
  }
  float irradiance = 0;
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    float lamp = 0;  // the sum over its points
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LightPoint& light = frame.lights[i];
      Effect kind = light.material != kNone                                       ? Effect::area_light
                    : run.sample == find_light_sampler(Effect::directional_light) ? Effect::directional_light
                                                                                  : Effect::point_light;
      lamp += irradiance_bound(frame, light, kind, {light.position, light.position});
      const std::uint32_t points = run.polygons ? frame.settings.points_per_area_light : 1, next = i + 1 - run.begin;
      if (next % points) continue;
      if (run.polygons) lamp = std::max(lamp, lamp_bound(frame, run.polygons[next / points - 1], light));
      irradiance += std::exchange(lamp, 0.0f);
    }
  }
  const float lit = scattering > 0 && irradiance > 0 ? scattering * irradiance : 0;  // not 0 × ∞
  const bool shows_environment = has(frame.mask, Effect::environment) && environment_of(scene);
  const float leaves = glow + lit, background = max_component(shows_environment ? environment_of(scene)->radiance_max
                                                                                : scene.info.background);
  float bound = shows_environment ? background : max_component(frame.beyond_depth);
  RadianceBounds bounds;
  for (std::uint32_t i = 0; i <= frame.settings.ray_depth; ++i) {
    bound = std::max(leaves + (reflectance > 0 ? reflectance * bound : 0), background);
    CHECK_GE(bound, background);                  // fails for NaN, too
    bounds.after[i] = round_up(bound * 1.0001f);  // covers rounding of the sums
  }
  return bounds;
}

}  // namespace pocketray
