#include "desktop/accuracy/sweep_plan.h"

#include <algorithm>

#include "base/check.h"
#include "desktop/accuracy/covering.h"
#include "effect/effect_list.h"
#include "effect/setting_list.h"

namespace pocketray {
namespace {

// Returns the least accurate, the baseline's and the best of the available values, each once.
std::vector<const SweepPoint*> levels_of(const SweepPlan& plan, const SweptKnob& swept) {
  std::vector<const SweepPoint*> there, levels;
  for (std::size_t i = 0; i < swept.count; ++i)
    if (plan.points[swept.first + i].missing.empty()) there.push_back(&plan.points[swept.first + i]);
  for (const SweepPoint* point : there)
    if (point == there.front() || point == there.back() || point->is_default) levels.push_back(point);
  return levels;
}

void add_knob(const Knob& knob, const Configuration& baseline, const std::function<Status(const Settings&)>& can_be_had,
              const BakeableScene* bakeable, SweepPlan* plan) {
  std::vector<double> values = knob_values(knob, baseline);
  plan->knobs.push_back({&knob, plan->points.size(), values.size()});
  for (double value : values) {
    SweepPoint point = {knob.name, value_label(knob, value), baseline, 1, "", value == knob.get(baseline), true, ""};
    point.is_choice = point.is_default || knob.is_setting;
    knob.set(&point.configuration, value);
    point.price = relative_price(knob, baseline, value);
    Status status = can_be_had(point.configuration.settings);
    if (!status.ok) point.missing = status.message;
    if (is_bake_choice(knob) && !point.is_default) point.missing = knob.bake_unfit(*bakeable, value);
    plan->points.push_back(point);
  }
}

// Returns whether any value but the baseline's can be baked; otherwise *why receives the reason.
bool bake_applies(const Knob& knob, const Configuration& baseline, const BakeableScene& bakeable, std::string* why) {
  for (double value : knob.values) {
    if (value == knob.get(baseline)) continue;
    const std::string unfit = knob.bake_unfit(bakeable, value);
    if (unfit.empty()) return true;
    *why = unfit;
  }
  return false;
}

void add_covering_set(const Configuration& baseline, double price_limit, SweepPlan* plan) {
  std::vector<std::vector<const SweepPoint*>> levels;
  std::vector<std::vector<double>> prices;
  std::vector<const Knob*> knobs;
  for (const SweptKnob& swept : plan->knobs) {
    if (swept.knob->alone) continue;
    knobs.push_back(swept.knob);
    levels.push_back(levels_of(*plan, swept));
    prices.emplace_back();
    for (const SweepPoint* point : levels.back()) prices.back().push_back(point->price);
  }
  Covering covering = cover_pairs(prices, price_limit);
  std::vector<SweepPoint> points;
  for (const std::vector<int>& row : covering.rows) {
    SweepPoint point = {"several", "", baseline, 1, "", false, true, ""};
    int turned = 0;
    for (std::size_t k = 0; k < row.size(); ++k) {
      const SweepPoint& level = *levels[k][static_cast<std::size_t>(row[k])];
      const Knob& knob = *knobs[k];
      point.price *= level.price;
      if (level.is_default) continue;
      knob.set(&point.configuration, knob.get(level.configuration));
      point.is_choice = point.is_choice && knob.is_setting;
      point.value += (turned++ ? ", " : "") + level.knob + " " + level.value;
    }
    if (turned > 1) points.push_back(point);  // others are already measured
  }
  plan->points.insert(plan->points.end(), points.begin(), points.end());
  char text[160];
  std::snprintf(text, sizeof text,
                "%zu configurations cover all pairs of values but %zu of %zu, which would take more than %g "
                "times the baseline",
                points.size(), covering.too_dear_count, covering.pair_count, price_limit);
  plan->notes.push_back(text);
}

bool is_planned(const SweepPlan& plan, const Configuration& configuration) {
  auto is_same = [&](const SweepPoint& point) {
    return std::all_of(knob_list().begin(), knob_list().end(),
                       [&](const Knob& knob) { return knob.get(point.configuration) == knob.get(configuration); });
  };
  return std::any_of(plan.points.begin(), plan.points.end(), is_same);
}

// Returns the knobs that can change from frame to frame.
std::vector<const Knob*> setting_knobs() {
  std::vector<const Knob*> knobs;
  for (const Knob& knob : knob_list())
    if (knob.is_setting) knobs.push_back(&knob);
  return knobs;
}

// Returns the baseline with the settings that the knobs control taken from `settings`.
SweepPoint several(const Configuration& baseline, const Settings& settings, const std::vector<const Knob*>& knobs) {
  Configuration wanted = baseline;
  wanted.settings = settings;
  SweepPoint point = {"several", "", baseline, 1, "", false, true, ""};
  for (const Knob* knob : knobs) {
    double value = knob->get(wanted);
    if (value == knob->get(baseline)) continue;
    knob->set(&point.configuration, value);
    point.price *= relative_price(*knob, baseline, value);
    point.value += (point.value.empty() ? "" : ", ") + (knob->name + (" " + value_label(*knob, value)));
  }
  return point;
}

// Adds the settings unless they are too expensive, unavailable or already present.
void add_settings(const Settings& settings, const std::vector<const Knob*>& knobs,
                  const std::function<Status(const Settings&)>& can_be_had, double price_limit, SweepPlan* plan) {
  SweepPoint point = several(plan->points[0].configuration, settings, knobs);
  bool wanted_too = point.price <= price_limit && can_be_had(point.configuration.settings).ok;
  if (wanted_too && !is_planned(*plan, point.configuration)) plan->points.push_back(point);
}

// Rays per pixel in comparisons of methods, since smooth edges count as much as indirect light.
constexpr std::uint32_t kMethodSamples = 4;
// Methods at kMethodSamples and a ladder are few settings, so each may take this many times as long as others. Where a
// frame is cheap, virtual lights cost many times as much, and are worth it: seesaw, CornellBox-Original.
constexpr double kMethodLimit = 2, kLadderLimit = 4;

// Adds each method of indirect light with every combination of its own settings, at the baseline's samples and at
// kMethodSamples.
void add_methods(const std::function<Status(const Settings&)>& can_be_had, double price_limit,
                 const std::function<EffectMask(const Settings&)>& effects_with, SweepPlan* plan) {
  const Settings baseline = plan->points[0].configuration.settings;
  const SettingRow& choice = *find_setting("indirect");
  const std::vector<const Knob*> knobs = setting_knobs();
  std::vector<EffectMask> done;
  auto add_method = [&](double value) {
    Settings settings = baseline;
    choice.field.set(&settings, value);
    const EffectMask method = effects_with(settings) & kIndirectEffects;
    if (std::find(done.begin(), done.end(), method) != done.end()) return;
    done.push_back(method);
    std::vector<Settings> combined = {settings};
    for (const SettingRow& row : kSettingList) {
      const bool is_its_own = (row.effects & method) != 0 && (row.effects & ~method) == 0;
      const std::size_t count = is_its_own ? combined.size() : 0;
      for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; k < row.sweep.count; ++k) {
          combined.push_back(combined[i]);
          row.field.set(&combined.back(), row.sweep.values[k]);
        }
    }
    for (Settings each : combined)
      for (std::uint32_t samples : {baseline.samples_per_pixel, kMethodSamples}) {
        each.samples_per_pixel = samples;
        add_settings(each, knobs, can_be_had, kMethodLimit * price_limit, plan);
      }
  };
  add_method(choice.field.get(baseline));
  for (int i = 0; i < choice.sweep.count; ++i) add_method(choice.sweep.values[i]);
}

const char* name_of_method(EffectMask effects) {
  for (const EffectRow& row : kEffectList)
    if ((effects & kIndirectEffects & bit(row.effect)) != 0) return row.name;
  return "none";
}

}  // namespace

SweepPlan plan_sweep(const std::string& scene, const EffectPlan& effects, const Configuration& baseline,
                     const std::function<Status(const Settings&)>& can_be_had, double price_limit,
                     const std::vector<Settings>& ladder,
                     const std::function<EffectMask(const Settings&)>& effects_with, const BakeableScene* bakeable) {
  SweepPlan plan;
  plan.points.push_back({"baseline", "", baseline, 1, "", true, true, ""});
  for (const Knob& knob : knob_list()) {
    std::string why;
    if (is_bake_choice(knob) && !bakeable) continue;
    if (is_bake_choice(knob) ? bake_applies(knob, baseline, *bakeable, &why) : knob_applies(knob, scene, effects, &why))
      add_knob(knob, baseline, can_be_had, bakeable, &plan);
    else
      plan.notes.push_back(std::string(knob.name) + " is skipped: " + why);
  }
  add_covering_set(baseline, price_limit, &plan);
  for (const Settings& settings : ladder)
    add_settings(settings, setting_knobs(), can_be_had, kLadderLimit * price_limit, &plan);
  if (!effects_with) return plan;
  add_methods(can_be_had, price_limit, effects_with, &plan);
  for (SweepPoint& point : plan.points)
    point.indirect = point.configuration.bake.patch_count > 0
                         ? kRadiosityEffect
                         : name_of_method(effects_with(point.configuration.settings));
  return plan;
}

}  // namespace pocketray
