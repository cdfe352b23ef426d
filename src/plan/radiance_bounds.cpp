#include "plan/radiance_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/clear_coat.h"
#include "brdf/iridescence.h"
#include "brdf/linear_lobe.h"
#include "brdf/sheen.h"
#include "indirect/environment.h"
#include "scene/diffuse_transmission.h"
#include "scene/metallic_roughness.h"
#include "shade/ambient_gloss.h"
#include "shade/dielectric.h"
#include "shade/frame_data.h"
#include "shade/lights.h"

namespace pocketray {
namespace {

// Upper bound of the surroundings' light that a material, or a coat of strength 1, sends out.
float glow_bound(const FrameData& frame, const Material& m, bool lit_by_environment) {
  const Scene& scene = *frame.scene;
  const bool is_even = lit_by_environment ? stores_surroundings(frame) : has(frame.mask, Effect::ambient_gloss);
  const float even = is_even ? reflected_surroundings_bound(surroundings_max(scene, frame.mask), m) : 0;
  return lit_by_environment ? even + environment_bound(scene, m, frame.mask) : even;
}

// Upper bounds of the radiance that surfaces of a material send out.
struct MaterialBound {
  float own;        // without light from lights
  float scattered;  // per irradiance of 1 by lights
  float passed;     // fraction of incoming radiance passed on, if it mirrors or transmits; otherwise 0
};

MaterialBound material_bound(const FrameData& frame, std::uint32_t index) {
  const Scene& scene = *frame.scene;
  CHECK_LT(index, scene.materials.count);
  const bool lit_by_environment = environment_lights(scene, frame.mask, frame.settings.indirect);
  const bool mapped = has(frame.mask, Effect::metallic_roughness) || has(frame.mask, Effect::transmission_map);
  Material m = mapped ? lobe_bounds(scene, index) : scene.materials[index];
  const float diffuse = max_component(m.diffuse);
  const Sheen* sheen = has(frame.mask, Effect::sheen) ? sheen_of(scene, index) : nullptr;
  if (sheen) m.diffuse += sheen->color;  // for light from everywhere
  if (has(frame.mask, Effect::iridescence) && iridescence_of(scene, index)) {
    if (!is_zero(m.specular)) m.specular = {1, 1, 1};
    if (!is_zero(m.mirror)) m.mirror = {1, 1, 1};
  }
  const DiffuseTransmission* passing =
      has(frame.mask, Effect::diffuse_transmission) ? diffuse_transmission_of(scene, index) : nullptr;
  const Vec3 passed = passing ? passing->color * passing->strength : Vec3{0, 0, 0};
  m.diffuse += passed;  // likewise: it comes from both sides
  const bool shines = m.unlit && has(frame.mask, Effect::emission);
  MaterialBound bound;
  bound.own = max_component(m.emission) + (shines ? max_component(m.diffuse) : indirect_bound(scene, m, frame.mask));
  if (has(frame.mask, Effect::instant_radiosity) && !shines)
    bound.own += max_component(m.diffuse) * (virtual_lights_of(frame.indirect)->irradiance_max / kPiF);
  bound.own += glow_bound(frame, m, lit_by_environment);
  const ClearCoat* coat = has(frame.mask, Effect::clear_coat) ? coat_of(scene, index) : nullptr;
  if (coat) bound.own += coat->strength * glow_bound(frame, coat_bounds(*coat), lit_by_environment);
  bound.passed = max_component(m.mirror);
  if (!is_zero(m.transmission)) bound.passed += max_component(max(m.transmission, Vec3{1, 1, 1}));
  if (coat) bound.passed += coat->strength * coat_mirror_share(coat->roughness_low);
  float f = std::max(diffuse, max_component(passed)) / kPiF;  // each light is on one side
  CHECK_LT(m.brdf, kBrdfCount);
  const BrdfInfo* lobe = kBrdfList[m.brdf];
  if (has(frame.mask, Effect::anisotropy) && has_grain(scene, index)) lobe = lobe->with_grain;
  const float linear = frame.lights.polygons.count && lobe->linear ? kLinearPeakMax : 1;
  if (!is_zero(m.specular)) f = f * lobe->diffuse_max + max_component(lobe->peak(m)) * linear;
  if (coat && has_lobe(*coat)) f += coat->strength * max_component(kBrdfList[kGgx]->peak(coat_bounds(*coat)));
  if (sheen) f += max_component(sheen->color) * sheen_peak(sheen->roughness_low);
  bound.scattered = f;
  return bound;
}

// Smallest squared distance between boxes.
float box_distance_square(const Box& a, const Box& b) {
  Vec3 d = max(max(b.low - a.high, a.low - b.high), Vec3{0, 0, 0});
  return dot(d, d);
}

bool passes_light_on(const FrameData& frame, std::uint32_t material) {
  const Scene& scene = *frame.scene;
  const Material& m = scene.materials[material];
  return !is_zero(m.mirror) || !is_zero(m.transmission) ||
         (scene.material_maps.count && has_lobe_map(scene.material_maps[material])) ||
         (has(frame.mask, Effect::clear_coat) && coat_of(scene, material));
}

// A light that shines on triangles and boxes.
struct LightReach {
  const FrameData* frame;
  const LightPoint* light;
  bool is_area;
  Box positions;  // bounds of the whole light
};

// Upper bound of the irradiance within a box up to `height` above the emitter's plane; falls as the box shrinks.
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
  if (is_beside(*reach.frame, *reach.light, triangle)) return 0;
  Box box = empty_box();
  float height = 0;
  for (std::uint32_t v : t.vertices()) {
    const Vec3& p = reach.frame->geometry.positions[v];
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
    // The sums of the largest and smallest products are the corners' heights, rounded like any vertex's.
    const Vec3 low = (box.low - from) * direction, high = (box.high - from) * direction;
    const Vec3 most = max(low, high), least = min(low, high);
    height = most.x + most.y + most.z;
    if (reach.light->two_sided) height = std::max(height, -(least.x + least.y + least.z));
  }
  return irradiance_within(reach, box, height);
}

// Upper bound of a light's irradiance on any triangle but its own; `positions` bounds the whole light.
float irradiance_bound(const FrameData& frame, const LightPoint& light, Effect kind, const Box& positions) {
  const float intensity = max_component(light.intensity);
  if (!(intensity > 0)) return 0;
  if (kind == Effect::directional_light) return intensity;
  const LightReach reach = {&frame, &light, kind == Effect::area_light, positions};
  const float most =
      frame.geometry.accel_info->largest(frame.geometry.accel, {&reach, box_irradiance, triangle_irradiance});
  return most < kRadianceMax ? most : kRadianceMax;
}

// Upper bound for a lamp in closed form, as if one of its points had all its light.
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

// Upper bound of the irradiance by all lights.
float irradiance_bound(const FrameData& frame) {
  float irradiance = 0;
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    float lamp = 0;  // sum over its points
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LightPoint& light = frame.lights.points[i];
      Effect kind = light.material != kNone                                       ? Effect::area_light
                    : run.sample == find_light_sampler(Effect::directional_light) ? Effect::directional_light
                                                                                  : Effect::point_light;
      float point = irradiance_bound(frame, light, kind, {light.position, light.position});
      for (std::uint32_t k = i; k < frame.lights.sample_points.count; k += frame.lights.points.count) {
        const LightPoint& of_sample = frame.lights.sample_points[k];
        if (kind == Effect::area_light)
          point = std::max(point, irradiance_bound(frame, of_sample, kind, {of_sample.position, of_sample.position}));
      }
      lamp += point;
      const std::uint32_t points = run.polygons ? frame.settings.points_per_area_light : 1, next = i + 1 - run.begin;
      if (next % points) continue;
      if (run.polygons) lamp = std::max(lamp, lamp_bound(frame, run.polygons[next / points - 1], light));
      irradiance += std::exchange(lamp, 0.0f);
    }
  }
  return irradiance;
}

float lit(float scattered, float irradiance) { return scattered > 0 && irradiance > 0 ? scattered * irradiance : 0; }

// Rounds up to a sixteenth of the next power of two: frames of an animation, whose lights and surfaces move a little,
// get equal bounds and so skip the same rays.
float round_up(float bound) {
  int exponent;
  float mantissa = std::frexp(bound, &exponent);
  return std::isfinite(bound) ? std::ldexp(std::ceil(mantissa * 16) / 16, exponent) : bound;
}

float surroundings_bound(const FrameData& frame, bool shows_environment) {
  const Scene& scene = *frame.scene;
  return max_component(shows_environment ? environment_of(scene)->radiance_max : scene.info.background);
}

}  // namespace

RadianceBounds radiance_bounds(const FrameData& frame) {
  const Scene& scene = *frame.scene;
  CHECK(scene.material_maps.empty() || scene.material_maps.count == scene.materials.count);
  const bool shows_environment = has(frame.mask, Effect::environment) && environment_of(scene);
  const float background = surroundings_bound(frame, shows_environment);
  // Maxima over surfaces that end paths, that pass on less light than they receive, and all others.
  MaterialBound end = {0, 0, 0}, weaken = {0, 0, 0}, keep = {0, 0, 0};
  float irradiance = -1;
  float fixed = 0;  // maximum for surfaces that weaken light if none is brighter: own / (1 − passed)
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    const MaterialBound m = material_bound(frame, i);
    const bool passes_on = passes_light_on(frame, i);
    if (m.scattered > 0 && irradiance < 0) irradiance = irradiance_bound(frame);
    const float own = m.own + lit(m.scattered, irradiance);
    MaterialBound& kind = !passes_on ? end : m.passed < 1 ? weaken : keep;
    kind.own = std::max(kind.own, own), kind.passed = std::max(kind.passed, m.passed);
    if (passes_on && m.passed < 1) fixed = std::max(fixed, own / (1 - m.passed));
  }
  float bound = shows_environment ? background : max_component(frame.cut_off.beyond_depth);
  RadianceBounds bounds;
  for (std::uint32_t i = 0; i <= kRayDepthMax; ++i) {
    auto passed_on = [&](const MaterialBound& kind) { return kind.own + (kind.passed > 0 ? kind.passed * bound : 0); };
    const float passed = std::max(passed_on(keep), std::min(passed_on(weaken), std::max(fixed, bound)));
    bound = std::max(std::max(end.own, passed), background);
    CHECK_GE(bound, background);                  // fails for NaN, too
    bounds.after[i] = round_up(bound * 1.0001f);  // covers rounding of the sums
  }
  return bounds;
}

bool has_branches(const Scene& scene) {
  if (scene.clear_coats.count > 0) return true;
  for (const Material& m : scene.materials)
    if (!is_zero(m.transmission)) return true;
  return false;
}

}  // namespace pocketray
