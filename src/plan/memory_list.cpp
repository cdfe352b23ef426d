#include "plan/memory_list.h"

#include "base/check.h"
#include "indirect/environment_lights.h"
#include "indirect/indirect_list.h"
#include "plan/place_light_polygons.h"
#include "plan/plan_effects.h"
#include "plan/plan_lights.h"
#include "shade/edges.h"
#include "shade/interleaved.h"
#include "shade/point_groups.h"
#include "shade/sample_points.h"
#include "shade/selective.h"
#include "shade/source_selection.h"

namespace pocketray {
namespace {

template <class Element>
std::size_t need_or_0(std::size_t count) {
  return count ? arena_need<Element>(count) : 0;
}

template <Effect effect>
std::size_t method_need(const Scene& scene, const PlannedFor& in) {
  return indirect_need(scene, in.settings, prepared_methods(scene, in.settings, in.mask) & bit(effect)).keep;
}

std::size_t groups_need(const Scene&, const PlannedFor& in) {
  return has_point_groups(in.settings, in.mask) && in.light_points ? point_groups_need(in.light_points) : 0;
}

std::size_t interleaved_need(const Scene&, const PlannedFor& in) {
  if (!is_interleaved(in.mask)) return 0;
  return arena_need<InterleavedPixel>(std::size_t(in.settings.threads) * kept_pixel_count(in.settings, in.mask));
}

using In = PlannedFor;
constexpr MemoryRow kRows[] = {
    {"indirect light", bit(Effect::ambient), method_need<Effect::ambient>},
    {"indirect light", bit(Effect::radiosity), method_need<Effect::radiosity>},
    {"indirect light", bit(Effect::instant_radiosity), method_need<Effect::instant_radiosity>},
    {"environment shadows", bit(Effect::environment_shadow),
     [](const Scene& scene, const In& in) {
       return need_or_0<EnvironmentLights>(plans_environment_lights(scene, in.settings));
     }},
    {"lights", kAlways, [](const Scene&, const In& in) { return need_or_0<LightPoint>(in.light_points); }},
    {"lights", bit(Effect::area_light),
     [](const Scene&, const In& in) { return need_or_0<LightPoint>(in.sample_points); }},
    {"lights", bit(Effect::area_light), groups_need},
    {"lights", bit(Effect::area_light),
     [](const Scene& scene, const In& in) { return need_or_0<LightPolygon>(light_polygon_count(scene, in.mask)); }},
    {"lights", bit(Effect::source_selection),
     [](const Scene&, const In& in) { return selection_need(in.settings, in.selected_points); }},
    {"neighbouring pixels", 0,
     [](const Scene&, const In& in) { return has(in.mask, Effect::selective) ? selective_need(in.settings) : 0; }},
    {"neighbouring pixels", 0, interleaved_need},
    {"neighbouring pixels", bit(Effect::undersampling) | bit(Effect::edge_sampling),
     [](const Scene&, const In& in) { return window_need(in.settings, in.mask); }},
};

Status find_need(const Scene& scene, const Settings& settings, EffectMask mask, PlannedFor* in) {
  CHECK(in != nullptr);
  *in = {settings, mask};
  RETURN_IF_ERROR(light_point_count(scene, settings, in->mask, &in->light_points));
  in->sample_points = sample_point_count(in->mask, in->light_points);
  in->selected_points = has(in->mask, Effect::source_selection) ? in->light_points : 0;
  return success();
}

// Compares the lights' points, too: arenas round up, so that one more may take as many bytes.
bool has_room(const MemoryRow& row, const Scene& scene, const PlannedFor& planned, const PlannedFor& in) {
  if (!(row.effects & in.mask)) return true;
  return in.light_points <= planned.light_points && in.sample_points <= planned.sample_points &&
         row.need(scene, in) <= row.need(scene, planned);
}

// Names the setting whose planned value would fit.
Status refuse(const MemoryRow& row, const Scene& scene, const PlannedFor& planned, const Settings& settings) {
  CHECK(row.part != nullptr && row.need != nullptr);
  for (const SettingRow& setting : kSettingList) {
    const double value = setting.field.get(settings), was = setting.field.get(planned.settings);
    if (value == was) continue;
    Settings without = settings;
    setting.field.set(&without, was);
    PlannedFor in;
    if (!find_need(scene, without, plan_effects(scene, without).mask, &in).ok || !has_room(row, scene, planned, in))
      continue;
    char text[64], was_text[64];
    describe_value(setting, value, 6, text, sizeof text);
    describe_value(setting, was, 6, was_text, sizeof was_text);
    return failure("memory is planned for --%s %s: plan with --%s %s", setting.name, was_text, setting.name, text);
  }
  return failure("memory for %s is planned for other settings: plan for these", row.part);
}

// Sums the needs that frames cannot do without, with these settings or others that may follow. Returns false if the
// lights need too many points.
bool sum_needs(const Scene& scene, const Settings& settings, std::size_t* bytes) {
  CHECK(bytes != nullptr);
  PlannedFor in;
  if (!find_need(scene, settings, plan_effects(scene, settings).mask, &in).ok) return false;
  *bytes = 0;
  for (const MemoryRow& row : kRows)
    if (row.effects) *bytes = size_sum(*bytes, row.need(scene, in));
  return true;
}

}  // namespace

Array<const MemoryRow> memory_rows() { return {kRows, sizeof kRows / sizeof kRows[0]}; }

Status check_planned(const Scene& scene, const PlannedFor& planned, const Settings& settings, EffectMask mask,
                     PlannedFor* in) {
  CHECK(in != nullptr);
  RETURN_IF_ERROR(find_need(scene, settings, mask, in));
  for (const MemoryRow& row : kRows)
    if (!has_room(row, scene, planned, *in)) return refuse(row, scene, planned, settings);
  return success();
}

Settings widest_settings(const Scene& scene, const Settings& settings, Array<const Quality> candidates) {
  CHECK(candidates.data != nullptr || candidates.empty());
  Settings widest = settings;
  std::size_t most = 0, bytes;
  if (sum_needs(scene, settings, &bytes)) most = bytes;
  for (const SettingRow& row : kSettingList)
    for (std::uint32_t i = 0; i < candidates.count; ++i) {
      const double value = row.field.get(candidates[i]);
      if (value == row.field.get(widest) || (i > 0 && value == row.field.get(candidates[i - 1]))) continue;
      Settings wider = widest;
      row.field.set(&wider, value);
      if (sum_needs(scene, wider, &bytes) && bytes > most) widest = wider, most = bytes;
    }
  return widest;
}

}  // namespace pocketray
