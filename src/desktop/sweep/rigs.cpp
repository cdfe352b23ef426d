#include "desktop/sweep/rigs.h"

#include <cstdio>

#include "base/check.h"
#include "desktop/sweep/bake_rig.h"
#include "plan/plan_effects.h"
#include "plan/plan_lights.h"
#include "plan/quality_level.h"

namespace pocketray {
namespace {

// The ladder, which --budget-ms uses without a measured front, is also measured, and so are the levels of quality.
std::vector<Settings> ladder_of(const Renderer& renderer) {
  Front front = builtin_front(renderer.effects.mask);
  for (int i = 0; i < kQualityLevelCount && front.count < kFrontCandidateMax; ++i)
    front.candidates[front.count++] = candidate_of(builtin_level(static_cast<QualityLevel>(i), renderer.effects.mask));
  drop_what_scene_ignores(&front, renderer.effects.mask);
  std::vector<Settings> ladder;
  for (std::uint32_t i = 0; i < front.count; ++i)
    ladder.push_back(with_candidate(renderer.settings, front.candidates[i]));
  return ladder;
}

}  // namespace

std::string key_of(const SceneChoice& choice) {
  const BakeChoices& b = choice.bake;
  char text[96];
  std::snprintf(text, sizeof text, "%u %u %d %d %u", choice.sphere_columns, b.texture_side_max, b.has_mip_maps,
                b.is_compressed, b.patch_count);
  return text;
}

SceneChoice scene_of(const Configuration& configuration) { return {configuration.sphere_columns, configuration.bake}; }

Rig* first_rig(const Rigs& rigs) {
  const auto found = rigs.by_scene.find(key_of(SceneChoice()));
  CHECK(found != rigs.by_scene.end());  // planned
  return found->second.get();
}

Status plan_rigs(Rigs* rigs, SweepPlan* plan) {
  const AccuracyOptions& options = rigs->options;
  std::unique_ptr<Rig>& first = rigs->by_scene[key_of(SceneChoice())];
  RETURN_IF_ERROR(open_rig(options, SceneChoice(), &first));
  Renderer* renderer = &first->opened.renderer;
  // Plans with the scene's own normals, whatever the baseline uses.
  Settings settings = first->baseline.settings;
  settings.normals = NormalMode::as_scene;
  RETURN_IF_ERROR(change_settings(renderer, settings));
  auto can_be_had = [&](const Settings& wanted) {
    std::uint32_t count;
    return light_point_count(renderer->scene, wanted, renderer->effects.mask, &count);
  };
  auto effects_with = [&](const Settings& wanted) { return plan_effects(renderer->scene, wanted).mask; };
  if (options.bakes)
    RETURN_IF_ERROR(find_bakeable(options.common.scene, first->opened, first->has_own_look, &rigs->bakeable));
  *plan = plan_sweep(options.common.scene, renderer->effects, first->baseline, can_be_had, options.price_limit,
                     ladder_of(*renderer), effects_with, options.bakes ? &rigs->bakeable : nullptr);
  return success();
}

Status rig_for(Rigs* rigs, const Configuration& configuration, Rig** rig) {
  CHECK(rig != nullptr);
  const float exposure = first_rig(*rigs)->opened.renderer.view.exposure;
  std::unique_ptr<Rig>& there = rigs->by_scene[key_of(scene_of(configuration))];
  if (!there) {
    RETURN_IF_ERROR(open_rig(rigs->options, scene_of(configuration), &there));
    there->opened.renderer.view.exposure = exposure;
  }
  *rig = there.get();
  return success();
}

Status reference_rig(Rigs* rigs, Rig** rig) {
  CHECK(rigs != nullptr);
  Configuration configuration = first_rig(*rigs)->baseline;
  if (rigs->options.common.scene == "cornell") configuration.sphere_columns = kReferenceColumns;
  if (rigs->bakeable.is_model && rigs->bakeable.texture_side > configuration.bake.texture_side_max)
    configuration.bake.texture_side_max = kTextureSideSwept;
  return rig_for(rigs, configuration, rig);
}

void close_rig(Rigs* rigs, const Rig* rig) {
  if (rig == first_rig(*rigs)) return;
  for (auto there = rigs->by_scene.begin(); there != rigs->by_scene.end(); ++there)
    if (there->second.get() == rig) {
      rigs->by_scene.erase(there);
      return;
    }
}

std::string id_of(const SweepPoint& point) { return point.value.empty() ? point.knob : point.knob + " " + point.value; }

bool is_measured(const SweepPlan& plan, std::size_t point_index) {
  CHECK_LT(point_index, plan.points.size());
  const SweepPoint& point = plan.points[point_index];
  return point_index == 0 || (point.missing.empty() && !point.is_default);
}

}  // namespace pocketray
