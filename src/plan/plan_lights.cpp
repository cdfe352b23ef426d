#include "plan/plan_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "brdf/brdf_list.h"
#include "indirect/environment.h"
#include "scene/metallic_roughness.h"
#include "shade/even_points.h"
#include "shade/lights.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr Effect kKinds[] = {Effect::point_light, Effect::spot_light, Effect::directional_light, Effect::area_light};
static_assert(sizeof kKinds / sizeof kKinds[0] == sizeof FrameData::light_runs / sizeof(LightRun), "a run for each");

// A piece of an area light: a triangle, or two that form a parallelogram, (a, b, c) and (a, c, d) with b − a = c − d.
struct Emitter {
  std::uint32_t triangle;
  bool parallelogram;
  double area;
  std::uint32_t first_vertex[2];  // of each triangle, the vertex that is a
};

double triangle_area(const FrameData& frame, std::uint32_t triangle) {
  const Triangle& t = frame.scene->triangles[triangle];
  Vec3 e1 = frame.positions[t.vertex(1)] - frame.positions[t.vertex(0)];
  Vec3 e2 = frame.positions[t.vertex(2)] - frame.positions[t.vertex(0)];
  // Scaled by a power of two, which is exact, so that edges of any length stay in range.
  int exponent;
  std::frexp(max_component(max(abs(e1), abs(e2))), &exponent);
  for (int axis = 0; axis < 3; ++axis)
    e1[axis] = std::ldexp(e1[axis], -exponent), e2[axis] = std::ldexp(e2[axis], -exponent);
  return std::ldexp(0.5 * static_cast<double>(length(cross(e1, e2))), 2 * exponent);
}

// The emitter that starts at a triangle. The halves of a parallelogram may begin at any of their vertices.
Emitter emitter_at(const FrameData& frame, std::uint32_t triangle) {
  const Scene& scene = *frame.scene;
  Emitter e = {triangle, false, triangle_area(frame, triangle), {0, 0}};
  if (triangle + 1 >= scene.triangles.count) return e;
  const Triangle &t = scene.triangles[triangle], &next = scene.triangles[triangle + 1];
  if (next.material() != t.material()) return e;
  auto corner = [&](const Triangle& of, std::uint32_t i) -> const Vec3& { return frame.positions[of.vertex(i % 3)]; };
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vec3 &a = corner(t, i), &b = corner(t, i + 1), &c = corner(t, i + 2);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!(corner(next, k) == a && corner(next, k + 1) == c)) continue;
      const Vec3 skew = (b - a) - (c - corner(next, k + 2));
      if (length(skew) > length(b - a) * 1e-3f) continue;
      e.parallelogram = true;
      e.first_vertex[0] = i, e.first_vertex[1] = k;
      e.area += triangle_area(frame, triangle + 1);
      return e;
    }
  }
  return e;
}

// Visits the emitters of one material in order.
template <class Visit>
void each_emitter(const FrameData& frame, std::uint32_t material, Visit visit) {
  const Scene& scene = *frame.scene;
  for (std::uint32_t i = 0; i < scene.triangles.count; ++i) {
    if (scene.triangles[i].material() != material) continue;
    Emitter e = emitter_at(frame, i);
    if (e.area > 0) visit(e);
    if (e.parallelogram) ++i;
  }
}

// Position of a cell's point on the emitter: barycentrics in the triangle, or in one half of the parallelogram. It is
// the centroid of the cell's image, so that the mean of the points is the emitter's own centroid.
void place_on_emitter(const Emitter& e, const Cell& cell, std::uint32_t* triangle, float* u, float* v) {
  *triangle = e.triangle;
  float x = static_cast<float>(0.5 * (cell.x_begin + cell.x_end)), y = static_cast<float>(cell.y);
  if (!e.parallelogram) {
    // Points (√x(1 − y), √xy) are uniform if x and y are [Turk 1990, "Generating random points in triangles", method
    // 1]; √x is averaged over the cell.
    double begin = cell.x_begin * std::sqrt(cell.x_begin), end = cell.x_end * std::sqrt(cell.x_end);
    double root = 2 * (end - begin) / (3 * (cell.x_end - cell.x_begin));
    *u = static_cast<float>(root * (1 - cell.y));
    *v = static_cast<float>(root * cell.y);
  } else {  // a + x(b − a) + y(d − a), with c = b + d − a
    const bool second = x < y;
    *triangle += second;
    // Weights of a, the vertex after it and the one before it.
    const float weights[3] = {1 - (second ? y : x), second ? x : x - y, second ? y - x : y};
    const std::uint32_t a = e.first_vertex[second];
    *u = weights[(1 + 3 - a) % 3];
    *v = weights[(2 + 3 - a) % 3];
  }
}

LightPoint point_on(const FrameData& frame, std::uint32_t triangle, float u, float v, double area) {
  const Scene& scene = *frame.scene;
  const Triangle& t = scene.triangles[triangle];
  const Material& m = scene.materials[t.material()];
  const Vec3 &a = frame.positions[t.vertex(0)], &b = frame.positions[t.vertex(1)], &c = frame.positions[t.vertex(2)];
  LightPoint p = {};
  p.position = a * (1 - u - v) + b * u + c * v;
  p.direction = normalize(cross(b - a, c - a));
  Vec3 emission = m.emission;
  if (m.emission_texture.texture != kNone && scene.uvs.count)
    emission *=
        sample_texture(scene, m.emission_texture, hit_uv(scene, triangle, u, v), frame.settings.texture_filter).rgb;
  constexpr float most = std::numeric_limits<float>::max();
  p.intensity = min(emission * static_cast<float>(area), Vec3{most, most, most});
  p.material = t.material();
  p.two_sided = m.double_sided;
  return p;
}

// The points that represent one emissive material, each with an equal share of its area.
std::uint32_t place_area_light(const FrameData& frame, std::uint32_t material, LightPoint* points) {
  std::uint32_t n = frame.settings.points_per_area_light;
  CHECK(n >= 1 && n <= kPointsPerAreaLightMax);
  double total = 0;
  each_emitter(frame, material, [&](const Emitter& e) { total += e.area; });
  if (!(total > 0)) return 0;
  double before = 0;
  std::uint32_t placed = 0;
  each_emitter(frame, material, [&](const Emitter& e) {
    before += e.area;
    // Shares whose middle (i + ½)/n of the area lies before the end of this emitter.
    double end = std::floor(before / total * n + 0.5);
    std::uint32_t last = end < n ? static_cast<std::uint32_t>(end) : n;
    std::uint32_t first = placed, here = last > first ? last - first : 0;
    for (std::uint32_t j = 0; j < here; ++j) {
      float u, v;
      std::uint32_t triangle;
      place_on_emitter(e, equal_cell(j, here), &triangle, &u, &v);
      points[placed++] = point_on(frame, triangle, u, v, total / n);
    }
  });
  CHECK_LE(placed, n);
  return placed;
}

bool is_emissive(const Scene& scene, std::uint32_t material) { return !is_zero(scene.materials[material].emission); }

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

// Smallest squared distance from a point to a box.
float box_distance_square(const Box& box, const Vec3& p) {
  Vec3 d = max(max(box.low - p, p - box.high), Vec3{0, 0, 0});
  return dot(d, d);
}

// A light that shines on triangles and boxes.
struct LightReach {
  const FrameData* frame;
  const LightPoint* light;
  bool is_area;
};

// Upper bound of the irradiance within a box that reaches as high over the emitter's plane; falls as the box shrinks.
float irradiance_within(const LightReach& reach, const Box& box, float height) {
  const LightPoint& light = *reach.light;
  const float square = box_distance_square(box, light.position);
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

// Upper bound of a light's irradiance on any triangle but its own.
float irradiance_bound(const FrameData& frame, const LightPoint& light, Effect kind) {
  const float intensity = max_component(light.intensity);
  if (!(intensity > 0)) return 0;
  if (kind == Effect::directional_light) return intensity;
  const LightReach reach = {&frame, &light, kind == Effect::area_light};
  const float most = frame.accel_info->largest(frame.accel, {&reach, box_irradiance, triangle_irradiance});
  return most < kRadianceMax ? most : kRadianceMax;
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
    for (std::uint32_t i = 0; i < scene.materials.count; ++i)
      if (is_emissive(scene, i)) n += settings.points_per_area_light;
  if (n > kPointLightCountMax)
    return failure("the scene's lights need %llu light points, at most %u are supported: use fewer per area light",
                   static_cast<unsigned long long>(n), kPointLightCountMax);
  *count = static_cast<std::uint32_t>(n);
  return success();
}

void place_lights(Array<const Light> lights, Array<LightPoint> points, FrameData* frame) {
  CHECK(frame != nullptr && frame->scene != nullptr);
  const Scene& scene = *frame->scene;
  std::uint32_t count = 0;
  frame->light_run_count = 0;
  for (Effect kind : kKinds) {
    if (!has(frame->mask, kind)) continue;
    std::uint32_t begin = count;
    if (kind == Effect::area_light) {
      for (std::uint32_t m = 0; m < scene.materials.count; ++m)
        if (is_emissive(scene, m)) count += place_area_light(*frame, m, points.data + count);
    } else {
      for (const Light& light : lights)
        if (effect_of(light.kind) == kind) points[count++] = to_point(light);
    }
    CHECK_LE(count, points.count);
    if (count > begin) frame->light_runs[frame->light_run_count++] = {begin, count, find_light_sampler(kind)};
  }
  frame->lights = {points.data, count};
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
    if (own > glow) glow = own;
    float passes =
        max_component(m.mirror) + (is_zero(m.transmission) ? 0 : max_component(max(m.transmission, Vec3{1, 1, 1})));
    if (passes > reflectance) reflectance = passes;
    float f = max_component(m.diffuse) / kPiF;
    CHECK_LT(m.brdf, kBrdfCount);
    if (!is_zero(m.specular)) f = f * kBrdfList[m.brdf]->diffuse_max + max_component(kBrdfList[m.brdf]->peak(m));
    if (f > scattering) scattering = f;
  }
  float irradiance = 0;
  for (int r = 0; r < frame.light_run_count; ++r) {
    for (std::uint32_t i = frame.light_runs[r].begin; i < frame.light_runs[r].end; ++i) {
      const LightPoint& light = frame.lights[i];
      Effect kind = light.material != kNone ? Effect::area_light
                    : frame.light_runs[r].sample == find_light_sampler(Effect::directional_light)
                        ? Effect::directional_light
                        : Effect::point_light;
      irradiance += irradiance_bound(frame, light, kind);
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
