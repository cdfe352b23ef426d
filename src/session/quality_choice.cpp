#include "session/quality_choice.h"

#include "plan/plan_effects.h"
#include "session/front_file.h"
#include "session/scene_identity.h"

namespace pocketray {
namespace {

bool is_given(const SettingOption& option, const SettingRow& row, const Settings& read) {
  return option.given ? option.given() : row.field.get(read) != row.field.get(Quality());
}

}  // namespace

void find_levels(const std::string& scene, const SceneSource& source, Renderer* renderer,
                 LevelMeaning (&levels)[kQualityLevelCount]) {
  CachedFront cached;
  ContentHash identity;
  if (identify_scene(source, renderer, &identity).ok)
    cached = read_cached_front(scene, identity, machine_name(renderer->pace.device, renderer->settings.threads));
  Front& front = cached.front;
  const bool is_measured = front.count > 1 && errors_known(front);
  const bool is_priced = is_measured && adopt_prices(&front, cached.prices);
  complete_scene(renderer);  // its lights decide whether the environment casts shadows
  Settings automatic = renderer->settings;
  automatic.indirect = IndirectChoice::automatic;
  const EffectMask effects = plan_effects(renderer->scene, automatic).mask;
  if (is_measured) show_24_bits(&front);
  for (int i = 0; i < kQualityLevelCount; ++i) {
    const auto level = static_cast<QualityLevel>(i);
    Front alone;
    alone.candidates[alone.count++] =
        is_measured ? level_of(front, level) : candidate_of(builtin_level(level, effects));
    drop_what_scene_ignores(&alone, effects);
    levels[i] = {alone.candidates[0], is_measured, is_priced};
  }
}

Status find_level_settings(const CommonOptions& o, const SceneSource& source, Renderer* renderer,
                           Quality (&settings)[kQualityLevelCount]) {
  Settings given;
  RETURN_IF_ERROR(read_settings(o, &given));
  LevelMeaning levels[kQualityLevelCount];
  find_levels(o.scene, source, renderer, levels);
  for (int level = 0; level < kQualityLevelCount; ++level) {
    const Settings alone = with_candidate(given, levels[level].candidate);
    Settings all = alone;
    for (int i = 0; i < kSettingCount; ++i)
      if (is_given(o.settings.options[i], kSettingList[i], given))
        kSettingList[i].field.set(&all, kSettingList[i].field.get(given));
    // The level asks for no effect that given settings turn off.
    const EffectMask lost = plan_effects(renderer->scene, alone).mask & ~plan_effects(renderer->scene, all).mask;
    for (const SettingRow& row : kSettingList)
      if (row.effects & lost) row.field.set(&all, row.field.get(given));
    settings[level] = all;
  }
  return success();
}

Status set_quality(const CommonOptions& o, const SceneSource& source, Renderer* renderer) {
  if (o.quality.empty()) return success();
  QualityLevel level;
  if (!find_quality_level(o.quality.c_str(), &level))
    return failure("--quality is '%.60s': it must be draft, low, medium, high or best", o.quality.c_str());
  Quality levels[kQualityLevelCount];
  RETURN_IF_ERROR(find_level_settings(o, source, renderer, levels));
  static_cast<Quality&>(renderer->settings) = levels[static_cast<int>(level)];
  return success();
}

}  // namespace pocketray
