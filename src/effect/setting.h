// What a row of setting_list.h says of a setting.
#pragma once
#include <initializer_list>
#include <limits>
#include <type_traits>

#include "base/limit_list.h"
#include "effect/settings.h"

namespace pocketray {

enum class SettingKind : std::uint8_t { count, real, choice };

// Where a setting lies in Quality. Values are doubles, which hold every count and float; of a choice the enumerator's
// number.
struct SettingField {
  SettingKind kind;
  Quantity quantity;         // its limits; a choice has none but its names
  const char* const* names;  // of a choice, in the order of its enumerators
  int name_count;
  double (*get)(const Quality& quality);
  void (*set)(Quality* quality, double value);  // within the limits
};

template <auto member>
double get_member(const Quality& quality) {
  return static_cast<double>(quality.*member);
}
template <auto member>
void set_member(Quality* quality, double value) {
  quality->*member = static_cast<std::decay_t<decltype(quality->*member)>>(value);
}

template <std::uint32_t Quality::*member>
constexpr SettingField count_field(Quantity limits) {
  return {SettingKind::count, limits, nullptr, 0, get_member<member>, set_member<member>};
}
template <float Quality::*member>
constexpr SettingField real_field(Quantity limits) {
  return {SettingKind::real, limits, nullptr, 0, get_member<member>, set_member<member>};
}
template <auto member, std::size_t n>
constexpr SettingField choice_field(const char* const (&names)[n]) {
  return {SettingKind::choice, Quantity(), names, static_cast<int>(n), get_member<member>, set_member<member>};
}

constexpr std::size_t text_length(const char* text) {
  std::size_t length = 0;
  while (text[length]) ++length;
  return length;
}

constexpr int kSweepValuesMax = 12;
struct SweepValues {
  double values[kSweepValuesMax] = {};
  int count = 0;
  constexpr SweepValues(std::initializer_list<double> list) {
    for (double value : list) values[count++] = value;
  }
};

constexpr EffectMask kAlways = ~EffectMask(0);
constexpr double kAsAsked = std::numeric_limits<double>::quiet_NaN();

struct SettingRow {
  const char* name;      // "samples": of the option --samples, in fronts and sweeps
  const char* what;      // "rays through each pixel"
  const char* note;      // what the option's help says beyond `what` and the range; may be empty
  const char* hud_name;  // over the picture; null: not shown there
  SettingField field;
  std::uint32_t wire_bytes;       // in the settings of a request, which follow the list's order
  EffectMask effects;             // it belongs to: what a sweep looks for
  EffectMask seen_with;           // where none of these is on, no picture depends on it
  bool places_lights;             // light points, or the bound on radiance, follow from it
  double exact;                   // what a reference is rendered with; kAsAsked: what was asked for
  SweepValues sweep;              // the least accurate first
  double (*price)(double value);  // what a frame takes, up to a factor; null: the value matters little
  const char* theory;             // of the slope of RMSE over time; empty: theory gives no number
};

}  // namespace pocketray
