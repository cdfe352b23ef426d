#include "plan/radiance_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/check.h"
#include "base/float_bits.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/clear_coat.h"
#include "indirect/environment.h"
#include "scene/metallic_roughness.h"
#include "shade/dielectric.h"
#include "shade/lights.h"

namespace pocketray {
namespace {

// Upper bound of what a coat of strength 1 reflects of the surroundings.
float coat_glow_bound(const FrameData& frame, const Material& coat, bool lit_by_environment) {
  if (lit_by_environment) return environment_bound(*frame.scene, coat, frame.mask);
  return has(frame.mask, Effect::ambient_gloss) ? reflected_surroundings_bound(frame.scene->info, coat) : 0;
}

// What surfaces of a material send out at most.
struct MaterialBound {
  float own;        // without light from lights
  float scattered;  // for an irradiance of 1 by lights
  float passed;     // of what its rays bring, where it mirrors or transmits; otherwise 0
};

MaterialBound material_bound(const FrameData& frame, std::uint32_t index) {
  const Scene& scene = *frame.scene;
  CHECK_LT(index, scene.materials.count);
  const bool lit_by_environment = environment_lights(scene, frame.mask, frame.settings.indirect);
  const bool mapped = has(frame.mask, Effect::metallic_roughness) && scene.material_maps.count;
  const Material m = mapped ? lobe_bounds(scene.materials[index], scene.material_maps[index]) : scene.materials[index];
  const bool shines = m.unlit && has(frame.mask, Effect::emission);
  MaterialBound bound;
  bound.own = max_component(m.emission) + (shines ? max_component(m.diffuse) : indirect_bound(scene, m, frame.mask));
  if (has(frame.mask, Effect::instant_radiosity) && !shines)
    bound.own += max_component(m.diffuse) * (virtual_lights_of(frame.indirect)->irradiance_max / kPiF);
  if (lit_by_environment)
    bound.own += environment_bound(scene, m, frame.mask);
  else if (has(frame.mask, Effect::ambient_gloss))
    bound.own += reflected_surroundings_bound(scene.info, m);
  const ClearCoat* coat = has(frame.mask, Effect::clear_coat) ? coat_of(scene, index) : nullptr;
  if (coat) bound.own += coat->strength * coat_glow_bound(frame, coat_bounds(*coat), lit_by_environment);
  bound.passed = max_component(m.mirror);
  if (!is_zero(m.transmission)) bound.passed += max_component(max(m.transmission, Vec3{1, 1, 1}));
  if (coat) bound.passed += coat->strength * coat_mirror_share(coat->roughness_low);
  float f = max_component(m.diffuse) / kPiF;
  CHECK_LT(m.brdf, kBrdfCount);
  const BrdfInfo* lobe = kBrdfList[m.brdf];
  if (has(frame.mask, Effect::anisotropy) && has_grain(scene, index)) lobe = lobe->with_grain;
  if (!is_zero(m.specular)) f = f * lobe->diffuse_max + max_component(lobe->peak(m));
  if (coat && has_lobe(*coat)) f += coat->strength * max_component(kBrdfList[kGgx]->peak(coat_bounds(*coat)));
  bound.scattered = f;
  return bound;
}

// Smallest squared distance between boxes.
float box_distance_square(const Box& a, const Box& b) {
  Vec3 d = max(max(b.low - a.high, a.low - b.high), Vec3{0, 0, 0});
  return dot(d, d);
}

// The surfaces that a bound is for.
enum class Receivers { end_paths, pass_light_on };

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
  Receivers receivers;
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
  if (passes_light_on(*reach.frame, t.material()) != (reach.receivers == Receivers::pass_light_on)) return 0;
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

// Upper bound of a light's irradiance on any such triangle but its own, or, with `box`, on those within; `positions`
// holds all that it is.
float irradiance_bound(const FrameData& frame, const LightPoint& light, Effect kind, const Box& positions,
                       Receivers receivers, const Box* box) {
  const float intensity = max_component(light.intensity);
  if (!(intensity > 0)) return 0;
  if (kind == Effect::directional_light) return intensity;
  const LightReach reach = {&frame, &light, kind == Effect::area_light, receivers, positions};
  const float most = box ? box_irradiance(&reach, *box)
                         : frame.accel_info->largest(frame.accel, {&reach, box_irradiance, triangle_irradiance});
  return most < kRadianceMax ? most : kRadianceMax;
}

// The same for a lamp in closed form, as if one of its points had all its light.
float lamp_bound(const FrameData& frame, const LightPolygon& polygon, LightPoint point, Receivers receivers,
                 const Box* box) {
  if (!polygon.corner_count) return 0;
  Box corners = empty_box();
  for (std::uint32_t i = 0; i < polygon.corner_count; ++i) corners = merge(corners, polygon.corners[i]);
  point.position = polygon.corners[0], point.direction = polygon.normal;
  constexpr float most = std::numeric_limits<float>::max();
  point.intensity = min(point.intensity * static_cast<float>(frame.settings.points_per_area_light), {most, most, most});
  const float surrounded = kPiF * max_component(polygon.radiance);
  return std::min(surrounded, irradiance_bound(frame, point, Effect::area_light, corners, receivers, box));
}

// Upper bound of the irradiance by all lights, on such triangles or, with `box`, within.
float irradiance_bound(const FrameData& frame, Receivers receivers, const Box* box) {
  float irradiance = 0;
  for (int r = 0; r < frame.light_run_count; ++r) {
    const LightRun& run = frame.light_runs[r];
    float lamp = 0;  // the sum over its points
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LightPoint& light = frame.lights[i];
      Effect kind = light.material != kNone                                       ? Effect::area_light
                    : run.sample == find_light_sampler(Effect::directional_light) ? Effect::directional_light
                                                                                  : Effect::point_light;
      lamp += irradiance_bound(frame, light, kind, {light.position, light.position}, receivers, box);
      const std::uint32_t points = run.polygons ? frame.settings.points_per_area_light : 1, next = i + 1 - run.begin;
      if (next % points) continue;
      if (run.polygons)
        lamp = std::max(lamp, lamp_bound(frame, run.polygons[next / points - 1], light, receivers, box));
      irradiance += std::exchange(lamp, 0.0f);
    }
  }
  return irradiance;
}

float lit(float scattered, float irradiance) { return scattered > 0 && irradiance > 0 ? scattered * irradiance : 0; }

// To a sixteenth of the next power of two: frames of an animation, whose lights and surfaces move a little, have the
// same bound and so leave out the same rays.
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
  // Of surfaces that end paths, of those that pass on less than comes, and of others.
  MaterialBound end = {0, 0, 0}, weaken = {0, 0, 0}, keep = {0, 0, 0};
  float irradiance[2] = {-1, -1};
  float fixed = 0;  // the most that surfaces which weaken light can have if none is brighter: own / (1 − passed)
  for (std::uint32_t i = 0; i < scene.materials.count; ++i) {
    const MaterialBound m = material_bound(frame, i);
    const bool passes_on = passes_light_on(frame, i);
    float& arriving = irradiance[passes_on];
    if (m.scattered > 0 && arriving < 0)
      arriving = irradiance_bound(frame, passes_on ? Receivers::pass_light_on : Receivers::end_paths, nullptr);
    const float own = m.own + lit(m.scattered, arriving);
    MaterialBound& kind = !passes_on ? end : m.passed < 1 ? weaken : keep;
    kind.own = std::max(kind.own, own), kind.passed = std::max(kind.passed, m.passed);
    if (passes_on && m.passed < 1) fixed = std::max(fixed, own / (1 - m.passed));
  }
  float bound = shows_environment ? background : max_component(frame.beyond_depth);
  RadianceBounds bounds;
  for (std::uint32_t i = 0; i <= kRayDepthMax; ++i) {
    auto passed_on = [&](const MaterialBound& kind) { return kind.own + (kind.passed > 0 ? kind.passed * bound : 0); };
    const float passed = std::max(passed_on(keep), std::min(passed_on(weaken), std::max(fixed, bound)));
    bounds.passed_on[i] = round_up(passed * 1.0001f);  // covers rounding of the sums
    bound = std::max(std::max(end.own, passed), background);
    CHECK_GE(bound, background);  // fails for NaN, too
    bounds.after[i] = round_up(bound * 1.0001f);
  }
  return bounds;
}

namespace {

// Of surfaces within a box.
struct RegionQuery {
  const FrameData* frame;
  Box box;
  float irradiance;
  // Of the material of the last triangle: neighbours often share one.
  mutable std::uint32_t material = kNone;
  mutable float value = 0;
};

bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis])) return false;
  return true;
}
Box triangle_box(const FrameData& frame, const Triangle& t) {
  Box box = empty_box();
  for (std::uint32_t v : t.vertices()) box = merge(box, frame.positions[v]);
  return box;
}
float most_in_box(const void* context, const Box& box) {
  return overlap(static_cast<const RegionQuery*>(context)->box, box) ? kRadianceMax : 0;
}
// Light that leaves a surface that ends paths.
float end_radiance(const void* context, std::uint32_t triangle) {
  const RegionQuery& query = *static_cast<const RegionQuery*>(context);
  const Triangle& t = query.frame->scene->triangles[triangle];
  if (!overlap(query.box, triangle_box(*query.frame, t))) return 0;
  if (t.material() != query.material) {
    const MaterialBound m = material_bound(*query.frame, t.material());
    query.material = t.material();
    query.value = passes_light_on(*query.frame, t.material()) ? 0 : m.own + lit(m.scattered, query.irradiance);
  }
  return query.value;
}
// 1 of a surface that passes light on.
float is_passing(const void* context, std::uint32_t triangle) {
  const RegionQuery& query = *static_cast<const RegionQuery*>(context);
  const Triangle& t = query.frame->scene->triangles[triangle];
  return passes_light_on(*query.frame, t.material()) && overlap(query.box, triangle_box(*query.frame, t)) ? 1 : 0;
}
float one_in_box(const void* context, const Box& box) { return most_in_box(context, box) > 0 ? 1 : 0; }

// The cell and a sixteenth of it around: more than hits and rays' origins are off by rounding.
Box box_of_cell(const Box& bounds, int region) {
  CHECK(region >= 0 && region < kRegionCount);
  Box cell;
  for (int axis = 0; axis < 3; ++axis, region /= kRegionSide) {
    const float size = (bounds.high[axis] - bounds.low[axis]) / kRegionSide;
    const float begin = bounds.low[axis] + size * static_cast<float>(region % kRegionSide);
    cell.low[axis] = begin - size / 16, cell.high[axis] = begin + size + size / 16;
  }
  return cell;
}

// Each cell's most becomes that of all cells from there on towards the octant.
void reach_across(RadianceRegions* regions, int octant, int axis) {
  const int stride = axis == 0 ? 1 : axis == 1 ? kRegionSide : kRegionSide * kRegionSide;
  CHECK(octant >= 0 && octant < 8 && axis >= 0 && axis < 3);
  const int bit = 1 << octant, step = octant >> axis & 1 ? -stride : stride;
  for (int i = 0; i < kRegionCount; ++i) {
    const int region = step > 0 ? kRegionCount - 1 - i : i, place = region / stride % kRegionSide;
    if (place == (step > 0 ? kRegionSide - 1 : 0)) continue;
    regions->ends[region][octant] = std::max(regions->ends[region][octant], regions->ends[region + step][octant]);
    regions->passes[region] |= static_cast<std::uint8_t>(regions->passes[region + step] & bit);
  }
}

std::uint32_t hash_of(const RadianceRegions& regions) {
  std::uint32_t hash = 2166136261u;  // FNV-1
  auto add = [&](std::uint32_t bits) { hash = hash * 16777619u ^ bits; };
  for (int region = 0; region < kRegionCount; ++region) {
    for (float most : regions.ends[region]) add(float_bits(most));
    add(regions.passes[region]);
  }
  return hash;
}

}  // namespace

void place_radiance_regions(const FrameData& frame, RadianceBounds* bounds, RadianceRegions* regions) {
  CHECK(bounds != nullptr && regions != nullptr);
  CHECK(frame.scene != nullptr && frame.accel_info != nullptr);
  Box box = empty_box();
  for (const Vec3& p : frame.positions) box = merge(box, p);
  regions->low = box.low;
  for (int axis = 0; axis < 3; ++axis) {
    const float size = box.high[axis] - box.low[axis];
    regions->cells_per_unit[axis] = size > 0 && size < kRadianceMax ? kRegionSide / size : 0;
  }
  const bool shows_environment = has(frame.mask, Effect::environment) && environment_of(*frame.scene);
  const float background = surroundings_bound(frame, shows_environment);
  const float anywhere = irradiance_bound(frame, Receivers::end_paths, nullptr);
  for (int region = 0; region < kRegionCount; ++region) {
    RegionQuery query = {&frame, box_of_cell(box, region), anywhere};
    const float here = irradiance_bound(frame, Receivers::end_paths, &query.box);
    if (here < anywhere) query.irradiance = here;
    const float most = frame.accel_info->largest(frame.accel, {&query, most_in_box, end_radiance});
    const float end = round_up(std::max(most, background) * 1.0001f);
    const bool passes = frame.accel_info->largest(frame.accel, {&query, one_in_box, is_passing}) > 0;
    for (float& at : regions->ends[region]) at = std::min(end, bounds->after[0]);
    regions->passes[region] = passes ? 0xff : 0;
  }
  for (int octant = 0; octant < 8; ++octant)
    for (int axis = 0; axis < 3; ++axis) reach_across(regions, octant, axis);
  bounds->regions_hash = hash_of(*regions);
}

bool has_radiance_regions(const Scene& scene) {
  for (const Material& m : scene.materials)
    if (!is_zero(m.transmission)) return true;
  return false;
}

bool has_branches(const Scene& scene) { return scene.clear_coats.count > 0 || has_radiance_regions(scene); }

}  // namespace pocketray
