#include "plan/plan_lights.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"
#include "base/limits.h"
#include "plan/area_light.h"
#include "shade/lights.h"
#include "shade/sample_points.h"

namespace pocketray {
namespace {

constexpr Effect kKinds[] = {Effect::point_light, Effect::spot_light, Effect::directional_light, Effect::area_light};
static_assert(sizeof kKinds / sizeof kKinds[0] == sizeof Lights::runs / sizeof(LightRun), "a run for each");

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

// Chosen: a disc of 1° has as many points as an area light, up to 16, and smaller ones have fewer: the sun's own disc
// widens the edges of most shadows by less than a pixel.
constexpr float kFullRadius = static_cast<float>(radians(1));
constexpr std::uint32_t kSunPointsMax = 16;

// The light's disc in the sky, or null: all of it comes from one direction.
const EnvironmentSun* disc_of(const Scene& scene, std::uint32_t light) {
  for (const EnvironmentSun& sun : scene.environment_suns)
    if (sun.light == light && sun.radius > 0) return &sun;
  return nullptr;
}

std::uint32_t point_count(const Scene& scene, const Settings& settings, std::uint32_t light) {
  const EnvironmentSun* disc = disc_of(scene, light);
  if (!disc) return 1;
  const float share = std::min(disc->radius / kFullRadius, 1.0f) * static_cast<float>(settings.points_per_area_light);
  return std::clamp(static_cast<std::uint32_t>(share), 1u, kSunPointsMax);
}

// Divides a directional light among points evenly over its disc: on a spiral that turns by the golden angle [Vogel
// 1979, "A better way to construct the sunflower head"].
void place_disc(const Light& light, float radius, std::uint32_t count, LightPoint* points) {
  constexpr double kGoldenAngle = 2.39996322972865332;
  Vec3 across, along;
  make_basis(light.direction, &across, &along);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = kGoldenAngle * i;
    const float off = radius * std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
    points[i] = to_point(light);
    points[i].intensity = light.intensity * (1 / static_cast<float>(count));
    if (count > 1)
      points[i].direction = normalize(light.direction + across * (off * static_cast<float>(det_cos(turn))) +
                                      along * (off * static_cast<float>(det_sin(turn))));
  }
}

}  // namespace

Status light_point_count(const Scene& scene, const Settings& settings, EffectMask mask, std::uint32_t* count) {
  CHECK(count != nullptr);
  std::uint64_t n = 0;
  for (std::uint32_t i = 0; i < scene.lights.count; ++i)
    if (has(mask, effect_of(scene.lights[i].kind))) n += point_count(scene, settings, i);
  if (has(mask, Effect::area_light))
    each_lamp(scene, scene.materials, [&](const Lamp&) { n += settings.points_per_area_light; });
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
  frame->lights.run_count = 0;
  frame->lights.sample_points = {};  // of other lights
  frame->lights.sun_begin = frame->lights.sun_end = 0;
  for (Effect kind : kKinds) {
    if (!has(frame->mask, kind)) continue;
    std::uint32_t begin = count;
    if (kind == Effect::area_light) {
      each_lamp(*frame->scene, lamps, [&](const Lamp& lamp) {
        count += place_area_light(*frame, lamp, frame->settings.points_per_area_light, {}, points.data + count);
      });
    } else {
      for (std::uint32_t i = 0; i < lights.count; ++i) {
        if (effect_of(lights[i].kind) != kind) continue;
        const EnvironmentSun* disc = kind == Effect::directional_light ? disc_of(*frame->scene, i) : nullptr;
        if (!disc) {
          points[count++] = to_point(lights[i]);
          continue;
        }
        const std::uint32_t n = point_count(*frame->scene, frame->settings, i);
        place_disc(lights[i], disc->radius, n, points.data + count);
        if (disc->cos_shown <= 1) frame->lights.sun_begin = count, frame->lights.sun_end = count + n;
        count += n;
      }
    }
    CHECK_LE(count, points.count);
    if (count > begin)
      frame->lights.runs[frame->lights.run_count++] = {begin, count, find_light_sampler(kind), nullptr};
  }
  frame->lights.points = {points.data, count};
}

void place_sample_points(Array<const Material> lamps, Array<LightPoint> points, FrameData* frame) {
  CHECK(frame != nullptr);
  Lights& lights = frame->lights;
  CHECK(lights.sample_points.empty());
  const std::uint32_t sets = point_set_count(frame->settings, frame->mask);
  if (sets == 0 || lights.run_count == 0) return;
  const LightRun& run = lights.runs[lights.run_count - 1];
  if (run.sample != find_light_sampler(Effect::area_light)) return;
  CHECK_EQ(run.end, lights.points.count);
  CHECK_LE(std::uint64_t(sets) * lights.points.count, points.count);
  for (std::uint32_t set = 0; set < sets; ++set) {
    LightPoint* of_set = points.data + std::size_t(set) * lights.points.count;
    std::copy_n(lights.points.data, run.begin, of_set);
    std::uint32_t end = run.begin;
    each_lamp(*frame->scene, lamps, [&](const Lamp& lamp) {
      const std::uint32_t n = frame->settings.points_per_area_light,
                          seen = points_of_lamp(frame->settings, frame->mask, 1);
      if (place_area_light(*frame, lamp, seen, {set, sets}, of_set + end) == 0) return;
      for (std::uint32_t i = seen; i < n; ++i)
        of_set[end + i] = of_set[end + i % seen], of_set[end + i].intensity = {0, 0, 0};
      end += n;
    });
    CHECK_EQ(end, lights.points.count);
  }
  lights.sample_points = {points.data, sets * lights.points.count};
}

}  // namespace pocketray
