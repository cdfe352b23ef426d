#include "session/quality_dial.h"

#include "base/check.h"
#include "plan/memory_list.h"
#include "session/quality_choice.h"

namespace pocketray {
namespace {

// Plans for the settings asked for, and for as many levels as fit beside them.
Status plan_dial(const QualityDial& dial, Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
  const Settings asked = renderer->settings;
  RETURN_IF_ERROR(plan_renderer(renderer, storage, output));
  const bool falls_back = renderer->accel.is_fallback;
  const AccelInfo* const chosen = renderer->accel.info;
  const bool is_coherent = renderer->history.state.planned;
  const char* const because = renderer->history.state.unplanned_because;
  for (std::uint32_t count = kQualityLevelCount; count > 0; --count) {
    renderer->settings = widest_settings(renderer->scene, asked, {dial.levels, count});
    if (plan_renderer(renderer, storage, output).ok && renderer->accel.is_fallback == falls_back &&
        renderer->history.state.planned == is_coherent) {
      renderer->history.state.unplanned_because = because;  // as for the settings that were asked for
      return success();
    }
    renderer->accel.info = chosen;
  }
  renderer->settings = asked;
  return plan_renderer(renderer, storage, output);
}

}  // namespace

Status open_scene_with_dial(const CommonOptions& common, const std::function<OutputNeed(const Settings&)>& output_bytes,
                            OpenScene* opened, QualityDial* dial) {
  CHECK(opened != nullptr && dial != nullptr);
  *dial = QualityDial();
  if (!common.quality.empty()) find_quality_level(common.quality.c_str(), &dial->current);
  Settings asked;
  OpenHooks hooks;
  hooks.output_bytes = output_bytes;
  hooks.loaded = [&](const SceneSource& source, Renderer* renderer) {
    asked = renderer->settings;
    return find_level_settings(common, source, renderer, dial->levels);
  };
  hooks.plan = [&](Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
    return plan_dial(*dial, renderer, storage, output);
  };
  RETURN_IF_ERROR(open_scene(common, hooks, opened));
  RETURN_IF_ERROR(start_scene(opened, common));
  return change_settings(&opened->renderer, asked);
}

Status turn_dial(QualityDial* dial, int steps, Renderer* renderer) {
  CHECK(dial != nullptr && renderer != nullptr);
  const int wanted = static_cast<int>(dial->current) + steps;
  if (wanted < 0) return failure("draft is the lowest quality");
  if (wanted >= kQualityLevelCount) return failure("best is the highest quality");
  Settings settings = renderer->settings;
  static_cast<Quality&>(settings) = dial->levels[wanted];
  if (!change_settings(renderer, settings).ok)
    return failure("quality %s needs more memory than was planned: raise --memory", kQualityLevelNames[wanted]);
  dial->current = static_cast<QualityLevel>(wanted), dial->steps += steps;
  return success();
}

}  // namespace pocketray
