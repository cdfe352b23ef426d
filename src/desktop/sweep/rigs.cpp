#include "desktop/sweep/rigs.h"

#include "base/check.h"
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

Status plan_rigs(Rigs* rigs, SweepPlan* plan) {
  const AccuracyOptions& options = rigs->options;
  std::unique_ptr<Rig>& first = rigs->by_columns[kCornellSphereColumns];
  RETURN_IF_ERROR(open_rig(options, kCornellSphereColumns, &first));
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
  *plan = plan_sweep(options.common.scene, renderer->effects, first->baseline, can_be_had, options.price_limit,
                     ladder_of(*renderer), effects_with);
  return success();
}

Status rig_for(Rigs* rigs, const Configuration& configuration, Rig** rig) {
  CHECK(rig != nullptr && rigs->by_columns.count(kCornellSphereColumns) == 1);  // planned
  std::unique_ptr<Rig>& there = rigs->by_columns[configuration.sphere_columns];
  if (!there) {
    RETURN_IF_ERROR(open_rig(rigs->options, configuration.sphere_columns, &there));
    there->opened.renderer.view.exposure = rigs->by_columns[kCornellSphereColumns]->opened.renderer.view.exposure;
  }
  *rig = there.get();
  return success();
}

Status reference_rig(Rigs* rigs, Rig** rig) {
  CHECK(rigs != nullptr && rigs->by_columns.count(kCornellSphereColumns) == 1);  // planned
  Configuration configuration = rigs->by_columns[kCornellSphereColumns]->baseline;
  if (rigs->options.common.scene == "cornell") configuration.sphere_columns = kReferenceColumns;
  return rig_for(rigs, configuration, rig);
}

std::string id_of(const SweepPoint& point) { return point.value.empty() ? point.knob : point.knob + " " + point.value; }

bool is_measured(const SweepPlan& plan, std::size_t point_index) {
  CHECK_LT(point_index, plan.points.size());
  const SweepPoint& point = plan.points[point_index];
  return point_index == 0 || (point.missing.empty() && !point.is_default);
}

}  // namespace pocketray
