#include "desktop/accuracy/knob_list.h"

#include <algorithm>
#include <cstdio>

#include "base/check.h"
#include "effect/effect_list.h"
#include "effect/setting_list.h"

namespace pocketray {
namespace {

std::uint32_t whole(double value) { return static_cast<std::uint32_t>(value); }

std::string names_of(EffectMask effects) {
  std::string names;
  for (const EffectRow& row : kEffectList)
    if (has(effects, row.effect)) names += std::string(names.empty() ? "" : ", ") + row.name;
  return names;
}

// A choice's values are indices into the row's list, which is ordered by accuracy, not enumerators.
Knob knob_of(const SettingRow& row) {
  Knob knob;
  knob.name = row.name, knob.what = row.what, knob.theory = row.theory;
  knob.effect = names_of(row.effects);
  knob.needs = row.seen_with == kAlways ? 0 : row.effects;
  knob.price = row.price;
  bool is_choice = row.field.kind == SettingKind::choice;
  for (int i = 0; i < row.sweep.count; ++i) {
    knob.values.push_back(is_choice ? i : row.sweep.values[i]);
    if (is_choice) knob.labels.push_back(row.field.names[static_cast<int>(row.sweep.values[i])]);
  }
  knob.get = [&row, is_choice](const Configuration& c) {
    const double value = row.field.get(c.settings), *values = row.sweep.values;
    return is_choice ? static_cast<double>(std::find(values, values + row.sweep.count, value) - values) : value;
  };
  knob.set = [&row, is_choice](Configuration* c, double value) {
    row.field.set(&c->settings, is_choice ? row.sweep.values[whole(value)] : value);
  };
  return knob;
}

std::vector<Knob> make_knobs() {
  std::vector<Knob> knobs;
  for (const SettingRow& row : kSettingList) knobs.push_back(knob_of(row));
  const std::vector<Knob> others = {
      {"tessellation",
       "columns of triangles around the sphere",
       "geometry",
       0,
       "cornell",
       "facet error falls with the square of their width, ray time grows with its logarithm: faster than any power of "
       "time",
       {8, 16, 32, 64, 128},
       {},
       [](const Configuration& c) { return static_cast<double>(c.sphere_columns); },
       [](Configuration* c, double v) { c->sphere_columns = whole(v); },
       nullptr,
       false,
       false},
      {"output",
       "pixel format of the screen",
       "display",
       0,
       nullptr,
       "",
       {0, 1, 2},
       {kOutputFormats[0].name, kOutputFormats[1].name, kOutputFormats[2].name},
       [](const Configuration& c) { return static_cast<double>(c.output); },
       [](Configuration* c, double v) { c->output = static_cast<int>(v); },
       nullptr,
       false,
       false},
#ifdef POCKETRAY_HAVE_NETWORK
      {"near-lossless",
       "rows from a render server whose channels may be off by one level of the pixel format",
       "display",
       0,
       nullptr,
       "",
       {0, 1},
       {"on", "off"},
       [](const Configuration& c) { return c.near_lossless ? 0.0 : 1.0; },
       [](Configuration* c, double v) { c->near_lossless = v == 0; },
       nullptr,
       true,
       false},
#endif
  };
  knobs.insert(knobs.end(), others.begin(), others.end());
  for (Knob& knob : bake_knobs()) knobs.push_back(std::move(knob));
  return knobs;
}

}  // namespace

int find_output_format(const std::string& name) {
  for (int i = 0; i < kOutputFormatCount; ++i)
    if (name == kOutputFormats[i].name) return i;
  return -1;
}

const std::vector<Knob>& knob_list() {
  static const std::vector<Knob> knobs = make_knobs();
  return knobs;
}

Judge judge_of(const Knob& knob) {
  if (is_bake_choice(knob)) return knob.effect == kRadiosityEffect ? Judge::truth : Judge::model;
  return knob.needs != 0 && (knob.needs & ~kIndirectEffects) == 0 ? Judge::truth : Judge::model;
}

std::string value_label(const Knob& knob, double value) {
  for (std::size_t i = 0; i < knob.labels.size(); ++i)
    if (knob.values[i] == value) return knob.labels[i];
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::vector<double> knob_values(const Knob& knob, const Configuration& baseline) {
  std::vector<double> values = knob.values;
  CHECK(!values.empty());
  double own = knob.get(baseline);
  if (std::find(values.begin(), values.end(), own) != values.end()) return values;
  bool falls = values.front() > values.back();
  auto place = std::find_if(values.begin(), values.end(), [&](double v) { return falls ? v < own : v > own; });
  values.insert(place, own);
  return values;
}

bool knob_applies(const Knob& knob, const std::string& scene, const EffectPlan& plan, std::string* why) {
  if (knob.scene && scene != knob.scene) {
    *why = std::string("only in the built-in scene ") + knob.scene;
    return false;
  }
  if (knob.needs == 0 || (knob.needs & plan.mask) != 0) return true;
  why->clear();
  for (const EffectRow& row : kEffectList)
    if (has(knob.needs, row.effect))
      *why += (why->empty() ? "" : ", ") + std::string(plan.decisions[static_cast<int>(row.effect)].reason);
  return false;
}

double relative_price(const Knob& knob, const Configuration& baseline, double value) {
  return knob.price ? knob.price(value) / knob.price(knob.get(baseline)) : 1;
}

}  // namespace pocketray
