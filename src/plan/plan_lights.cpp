#include "plan/plan_lights.h"

#include <algorithm>

#include "base/check.h"
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

}  // namespace

Status light_point_count(const Scene& scene, const Settings& settings, EffectMask mask, std::uint32_t* count) {
  CHECK(count != nullptr);
  std::uint64_t n = 0;
  for (const Light& light : scene.lights) n += has(mask, effect_of(light.kind));
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
  for (Effect kind : kKinds) {
    if (!has(frame->mask, kind)) continue;
    std::uint32_t begin = count;
    if (kind == Effect::area_light) {
      each_lamp(*frame->scene, lamps,
                [&](const Lamp& lamp) { count += place_area_light(*frame, lamp, {}, points.data + count); });
    } else {
      for (const Light& light : lights)
        if (effect_of(light.kind) == kind) points[count++] = to_point(light);
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
  lights.sample_points = {};
  const std::uint32_t sets = point_set_count(frame->settings, frame->mask);
  if (sets == 0 || lights.run_count == 0) return;
  const LightRun& run = lights.runs[lights.run_count - 1];
  if (run.sample != find_light_sampler(Effect::area_light)) return;
  CHECK_LE(std::uint64_t(sets) * lights.points.count, points.count);
  for (std::uint32_t set = 0; set < sets; ++set) {
    LightPoint* of_set = points.data + std::size_t(set) * lights.points.count;
    std::copy_n(lights.points.data, run.begin, of_set);
    std::uint32_t end = run.begin;
    each_lamp(*frame->scene, lamps, [&](const Lamp& lamp) {
      end += place_area_light(*frame, lamp, {set, sets}, of_set + end);
    });
    CHECK_EQ(end, lights.points.count);
  }
  lights.sample_points = {points.data, sets * lights.points.count};
}

}  // namespace pocketray
